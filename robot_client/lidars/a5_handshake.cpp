#include "robot_client/lidars/a5_handshake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

constexpr auto kStopTime = 20ms; // a sensor needs some time until it takes the next request
constexpr auto kReplyTime = 500ms;
constexpr auto kSpinUpTime = 2s; // the motor turns before the first packet
constexpr int kTriesMax = 3;

} // namespace

LidarStep A5Handshake::begin() {
    bytes_.clear();
    starts_.clear();
    start_ = 0;
    return enter(State::kStopping);
}

LidarStep A5Handshake::enter(State state) {
    state_ = state;
    attempts_ = 1;
    return ask();
}

LidarStep A5Handshake::ask() const {
    switch (state_) {
    case State::kStopping: return {.send = a5_request(dialect_.stop), .timeout = kStopTime};
    case State::kAskingInfo: return {.send = a5_request(dialect_.info), .timeout = kReplyTime};
    case State::kAskingHealth: return {.send = a5_request(dialect_.health), .timeout = kReplyTime};
    case State::kStarting: return {.send = starts_.at(start_).request, .timeout = kSpinUpTime};
    case State::kDone: break;
    }
    return {.timeout = 0ms};
}

LidarStep A5Handshake::on_timeout() {
    if (state_ == State::kStopping) {
        bytes_.clear();
        return enter(State::kAskingInfo);
    }
    const bool has_other_start = state_ == State::kStarting && start_ + 1 < starts_.size();
    if (!has_other_start && ++attempts_ <= kTriesMax) return ask();
    if (has_other_start) {
        ++start_;
        return enter(State::kStarting);
    }
    return {.failure = Error{Errc::kTimeout, fmt::format("no answer of {} to a request; is it another device, or "
                                                         "another line speed (--baud)?",
                                                         dialect_.title)}};
}

/// Returns the descriptor that the state waits for.
A5Descriptor A5Handshake::awaited() const {
    if (state_ == State::kStarting) return starts_.at(start_).answer;
    return state_ == State::kAskingInfo ? kA5Info : kA5Health;
}

LidarStep A5Handshake::on_bytes(std::span<const std::uint8_t> bytes) {
    if (state_ == State::kStopping) return {};
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    LidarStep all;
    while (state_ != State::kDone) {
        const A5Descriptor wanted = awaited();
        const auto data = find_a5_descriptor(bytes_, wanted);
        if (!data) {
            // Bytes of an earlier measurement; the last ones may begin a descriptor.
            const auto kept = static_cast<std::ptrdiff_t>(std::min(bytes_.size(), kA5DescriptorBytes - 1));
            bytes_.erase(bytes_.begin(), bytes_.end() - kept);
            break;
        }
        const std::size_t size = wanted.is_repeated ? 0 : wanted.size;
        if (bytes_.size() < *data + size) break;
        LidarStep step = take(std::span<const std::uint8_t>(bytes_).subspan(*data, size));
        bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(*data + size));
        step.notes.insert(step.notes.begin(), all.notes.begin(), all.notes.end());
        all = std::move(step);
        if (all.failure) break;
    }
    return all;
}

/// Takes the data of the awaited answer.
LidarStep A5Handshake::take(std::span<const std::uint8_t> data) {
    if (state_ == State::kAskingInfo) {
        const A5Identity identity = read_a5_identity(data);
        starts_ = dialect_.starts(identity);
        LidarStep step = enter(State::kAskingHealth);
        auto note = fmt::format("connected to {}: {}", dialect_.title, text_of(identity));
        if (std::exchange(noted_, note) != note) step.notes.push_back(std::move(note));
        return step;
    }
    if (state_ == State::kStarting) return enter(State::kDone);
    const A5Condition condition = read_a5_condition(data);
    if (condition.state == A5Condition::State::kError) {
        return {.failure = Error{Errc::kUnreachable,
                                 fmt::format("{} reports that it is broken (error 0x{:04X}); unplug it and plug it in "
                                             "again, and check that nothing blocks its motor",
                                             dialect_.title, condition.code)}};
    }
    LidarStep step = enter(State::kStarting);
    if (condition.state == A5Condition::State::kWarning) {
        step.notes.push_back(fmt::format("{} reports a warning (0x{:04X})", dialect_.title, condition.code));
    }
    return step;
}

} // namespace scanloom::robot
