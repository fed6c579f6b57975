#include "tests/bench/localization/stage_sampler.hpp"

#include <boost/core/demangle.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <unordered_map>

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/time.h>

namespace scanloom::bench {
namespace {

constexpr int kFramesMax = 40;
constexpr long kPeriodMicroseconds = 1000; // many kernels round it up to 4 ms

struct StackSample {
    std::array<void*, kFramesMax> frames;
    int count;
};

// Of the only sampler, because a signal handler has no other data.
std::vector<StackSample> samples;
std::atomic<std::size_t> sampled = 0;

void take_sample(int) {
    const std::size_t index = sampled.load();
    if (index == samples.size()) return;
    samples[index].count = ::backtrace(samples[index].frames.data(), kFramesMax);
    sampled.store(index + 1);
}

void set_timer(long microseconds) {
    const itimerval timer{{0, microseconds}, {0, microseconds}};
    ::setitimer(ITIMER_PROF, &timer, nullptr);
}

/// @return the index of the stage whose function contains the address; stages.size() if none does
std::size_t stage_at(void* address, const std::vector<Stage>& stages) {
    Dl_info info{};
    if (::dladdr(address, &info) == 0 || info.dli_sname == nullptr) return stages.size();
    const std::string name = boost::core::demangle(info.dli_sname);
    const auto found = std::ranges::find_if(stages, [&](const Stage& stage) {
        return std::ranges::any_of(stage.functions,
                                   [&](std::string_view function) { return name.find(function) != std::string::npos; });
    });
    return static_cast<std::size_t>(found - stages.begin());
}

} // namespace

StageSampler::StageSampler() {
    samples.resize(kSamplesMax);
    sampled = 0;
    std::array<void*, 1> frame{};
    ::backtrace(frame.data(), 1); // loads a library, which a signal handler must not
    struct sigaction action {};
    action.sa_handler = take_sample;
    action.sa_flags = SA_RESTART;
    ::sigaction(SIGPROF, &action, nullptr);
    set_timer(kPeriodMicroseconds);
}

StageSampler::~StageSampler() { set_timer(0); }

std::vector<std::pair<std::string, double>> StageSampler::shares(const std::vector<Stage>& stages) {
    set_timer(0);
    std::vector<std::size_t> counts(stages.size() + 1);
    std::unordered_map<void*, std::size_t> known;
    for (std::size_t n = 0; n < sampled; ++n) {
        std::size_t stage = stages.size();
        for (int frame = 0; frame < samples[n].count && stage == stages.size(); ++frame) {
            void* const address = samples[n].frames[static_cast<std::size_t>(frame)];
            const auto [at, is_new] = known.try_emplace(address, stages.size());
            if (is_new) at->second = stage_at(address, stages);
            stage = at->second;
        }
        ++counts[stage];
    }
    std::vector<std::pair<std::string, double>> shares;
    for (std::size_t n = 0; n < counts.size(); ++n) {
        shares.emplace_back(n < stages.size() ? stages[n].name : "other",
                            static_cast<double>(counts[n]) / static_cast<double>(std::max<std::size_t>(sampled, 1)));
    }
    return shares;
}

} // namespace scanloom::bench
