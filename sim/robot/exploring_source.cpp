#include "sim/robot/exploring_source.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>
#include <variant>

namespace scanloom::sim {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

constexpr int kFailuresMax = 10;
constexpr double kRetryAfter = 1.0; // seconds of simulated time
constexpr int kTimesBlockedMax = 30;

} // namespace

ExploringSource::ExploringSource(SimulatorOptions options, SimulationLimits limits, robot::NoReturn no_return,
                                 double speed)
    : ExploringSource(std::move(options), limits, no_return, speed, std::make_unique<Explore>()) {}

ExploringSource::ExploringSource(SimulatorOptions options, SimulationLimits limits, robot::NoReturn no_return,
                                 double speed, std::unique_ptr<Explore> explore)
    : explore_(explore.get()), simulator_(std::move(options), std::move(explore)), limits_(limits),
      no_return_(no_return), speed_(speed) {
    limits_.scans = std::min(limits_.scans, scans_within(limits_.duration, simulator_.sensors().size()));
}

void ExploringSource::correct(const Pose2& T_map_odom, LocalizationState state) {
    simulator_.correct(T_map_odom);
    const bool is_lost = state == LocalizationState::kLost;
    if (is_lost && !is_lost_) explore_->look_around();
    is_lost_ = is_lost;
}

asio::awaitable<Result<std::optional<robot::Observation>>> ExploringSource::next() {
    assert(next_goal_);
    if (is_stopped_ || resumed_after_ + scans_ >= limits_.scans) co_return std::optional<robot::Observation>{};
    if (explore_->needs_goal()) {
        if (auto result = co_await request_goal(); !result) co_return result.error();
    }
    if (is_stopped_ || explore_->is_done()) co_return std::optional<robot::Observation>{};
    robot::Observation observation = observed(simulator_, no_return_);
    const std::uint64_t moments = resumed_after_ / simulator_.sensors().size();
    observation.scan.stamp += static_cast<double>(moments) * kScanPeriod;
    scans_ += 1;
    co_await wait_until_due(observation.scan.stamp);
    co_return std::optional(std::move(observation));
}

void ExploringSource::stop() {
    is_stopped_ = true;
    wake_.notify();
}

asio::awaitable<Result<>> ExploringSource::request_goal() {
    if (explore_->times_blocked() > kTimesBlockedMax) {
        const Pose2& pose = simulator_.pose();
        co_return Error{Errc::kNoPath, fmt::format("something blocks the robot at ({:.2f}, {:.2f}) for every goal; "
                                                   "check that place, or give another --seed",
                                                   pose.x, pose.y)};
    }
    auto answer = co_await (next_goal_() || wake_.wait());
    due_ = Clock::time_point::min(); // the simulation stood still meanwhile
    if (is_stopped_ || answer.index() != 0) co_return Result<>{};
    co_return take(std::get<0>(std::move(answer)));
}

Result<> ExploringSource::take(Result<robot::NextStop> answer) {
    if (!answer) {
        failures_ += 1;
        if (failures_ >= kFailuresMax) return answer.error();
        explore_->wait(kRetryAfter);
        return {};
    }
    failures_ = 0;
    switch (answer->outcome) {
    case robot::NextStop::Outcome::kGoal: explore_->go(std::move(answer->path), answer->target); break;
    case robot::NextStop::Outcome::kTakenByOthers: explore_->wait(kRetryAfter); break;
    case robot::NextStop::Outcome::kComplete: explore_->finish(); break;
    }
    return {};
}

/// Waits until a scan is due. Lost time is not made up for.
asio::awaitable<void> ExploringSource::wait_until_due(double stamp) {
    const double passed = stamp - std::exchange(stamp_, stamp); // zero between sensors that scan at the same time
    if (speed_ <= 0.0 || passed <= 0.0) co_return;
    due_ = std::max(due_, Clock::now());
    const auto due = due_;
    due_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(passed / speed_));
    if (!is_stopped_) co_await wake_.wait(due);
}

} // namespace scanloom::sim
