#include "tests/fault/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kFailuresMax = 10; // more failures give no further information

Outcome run_one(const Cases& cases, std::uint64_t seed, std::uint64_t count) {
    Outcome outcome;
    try {
        outcome = cases.run(seed, count);
    } catch (const std::exception& failure) {
        outcome.failures.emplace_back(failure.what());
    }
    if (outcome.passed()) return outcome;
    outcome.repeat = fmt::format("./scanloom fault {} --seed {} --count {}", cases.row, seed, count);
    if (outcome.failures.empty()) outcome.failures.emplace_back("scans are lost or duplicated, or the maps differ");
    for (auto& sentence : outcome.failures) sentence = fmt::format("{} [{}]", sentence, *outcome.repeat);
    return outcome;
}

/// The state that the threads share.
class Progress {
public:
    Progress(const Run& run, const Cases& cases) : run_(run), cases_(cases) {}

    void work() {
        for (;;) {
            const auto index = take();
            if (!index) return;
            const std::uint64_t count = std::min(cases_.of_count, run_.count - *index * cases_.of_count);
            keep(run_one(cases_, run_.seed + *index, count), count);
        }
    }

    [[nodiscard]] Outcome outcome() && { return std::move(outcome_); }

private:
    std::optional<std::uint64_t> take() {
        const std::lock_guard lock(mutex_);
        if (failures_ >= kFailuresMax || next_ * cases_.of_count >= run_.count) return std::nullopt;
        return next_++;
    }
    void keep(Outcome outcome, std::uint64_t count) {
        const std::lock_guard lock(mutex_);
        if (!outcome.passed()) ++failures_;
        outcome_.add(std::move(outcome));
        run_.on_progress(done_ += count);
    }

    const Run& run_;
    const Cases& cases_;
    std::mutex mutex_; // guards the members below
    std::uint64_t next_ = 0;
    std::uint64_t done_ = 0;
    std::uint64_t failures_ = 0;
    Outcome outcome_;
};

} // namespace

Outcome run_cases(const Run& run, const Cases& cases) {
    Progress progress(run, cases);
    std::vector<std::jthread> threads;
    for (std::size_t n = 1; n < cases.at_once; ++n) threads.emplace_back([&] { progress.work(); });
    progress.work();
    threads.clear(); // joins the threads
    return std::move(progress).outcome();
}

} // namespace scanloom::fault
