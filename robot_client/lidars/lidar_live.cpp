#include "robot_client/lidars/lidar_live.hpp"

#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/sources/messages.hpp"
#include "robot_client/sources/pose_feed.hpp"
#include "robot_client/sources/wake_signal.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <optional>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPosesKept = 4096; // 40 s of 100 a second
constexpr double kOtherClock = 60.0;     // seconds; no late pose is this far from a scan

} // namespace

/// State shared by the reading coroutines and next(). Timers and lines are in the frames of the coroutines, so they
/// never outlive their executor.
class LidarLive::State final : public std::enable_shared_from_this<LidarLive::State> {
public:
    explicit State(LidarLiveOptions options)
        : options_(std::move(options)), are_poses_coming_(options_.pose_descriptor >= 0) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (options_.pose_descriptor >= 0) ::close(options_.pose_descriptor); // never read
    }

    [[nodiscard]] asio::awaitable<Result<std::optional<Observation>>> next();
    void stop();
    [[nodiscard]] std::string remarks() const { return lidar_remarks(options_.driver->counts(), losses_); }

private:
    struct Waiting {
        Observation taken;
        Clock::time_point until; ///< it waits for a pose until then
    };

    /// The result of looking up the pose of a scan.
    struct Answer {
        std::optional<Pose2> pose;
        bool is_final = true;
    };

    void start(const asio::any_io_executor& executor);
    [[nodiscard]] static asio::awaitable<void> read_sensor(std::shared_ptr<State> self);
    [[nodiscard]] static asio::awaitable<void> read_poses(std::shared_ptr<State> self);
    void take_scans();
    void add(const StampedPose& pose);
    [[nodiscard]] Answer pose_for(const Waiting& waiting) const;
    [[nodiscard]] std::optional<Observation> take_ready();
    void report_other_clock(double stamp);
    [[nodiscard]] Result<std::optional<Observation>> end_when_stopped() const;

    LidarLiveOptions options_;
    std::deque<Waiting> waiting_;
    bool are_poses_coming_;
    LidarLosses losses_;
    std::uint64_t given_ = 0; ///< scans
    bool other_clock_reported_ = false;
    bool poses_ahead_reported_ = false;
    std::optional<Error> ended_; ///< why the sensor gives no more scans
    bool is_started_ = false;
    bool is_stopped_ = false;
    WakeSignal wake_; ///< of next()
    WakeSignal stop_; ///< of the reading coroutines
};

// Reading -------------------------------------------------------------------------------------------------------------

void LidarLive::State::start(const asio::any_io_executor& executor) {
    is_started_ = true;
    const auto at_end = [](const std::exception_ptr& failed) {
        if (failed) std::rethrow_exception(failed);
    };
    asio::co_spawn(executor, read_sensor(shared_from_this()), at_end);
    if (are_poses_coming_) asio::co_spawn(executor, read_poses(shared_from_this()), at_end);
}

asio::awaitable<void> LidarLive::State::read_sensor(std::shared_ptr<State> self) {
    const auto on_input = [state = self.get()] { state->take_scans(); };
    auto reading = read_lidar(self->options_.device, *self->options_.driver, on_input);
    const auto first = co_await (std::move(reading) || self->stop_.wait());
    if (const auto* error = std::get_if<0>(&first)) self->ended_ = *error;
    self->wake_.notify();
}

asio::awaitable<void> LidarLive::State::read_poses(std::shared_ptr<State> self) {
    const auto& note = self->options_.device.note;
    const auto on_pose = [state = self.get()](const StampedPose& pose) { state->add(pose); };
    auto reading = feed_poses(std::exchange(self->options_.pose_descriptor, -1), on_pose, note);
    const auto first = co_await (std::move(reading) || self->stop_.wait());
    if (const auto* end = std::get_if<0>(&first); end != nullptr && !end->empty()) {
        note(*end + "; scans after the last pose are skipped");
    }
    self->are_poses_coming_ = false;
    self->wake_.notify();
}

void LidarLive::State::take_scans() {
    while (auto taken = options_.driver->next()) {
        waiting_.push_back({std::move(*taken), Clock::now() + options_.pose_wait});
        if (waiting_.size() > kScansWaitingMax) {
            waiting_.pop_front();
            ++losses_.too_many_waiting;
        }
        wake_.notify();
    }
}

void LidarLive::State::add(const StampedPose& pose) {
    auto* timeline = std::get_if<PoseTimeline>(&options_.poses);
    if (timeline == nullptr) return;
    const double now = unix_now();
    const double latest = now + seconds(options_.pose_ahead_max);
    timeline->forget_after(latest); // the clock was set back
    if (pose.stamp > latest) {
        if (std::exchange(poses_ahead_reported_, true)) return;
        options_.device.note(fmt::format("poses are skipped: a pose with t = {:.0f} arrived at {:.0f}; for a device t "
                                         "is Unix time in seconds, and the clocks must agree",
                                         pose.stamp, now));
        return;
    }
    timeline->insert(pose);
    timeline->keep_newest(kPosesKept);
    wake_.notify();
}

// Giving --------------------------------------------------------------------------------------------------------------

asio::awaitable<Result<std::optional<Observation>>> LidarLive::State::next() {
    const auto self = shared_from_this();
    if (!is_started_ && !is_stopped_) start(co_await asio::this_coro::executor);
    while (!is_stopped_) {
        if (auto ready = take_ready()) co_return std::optional(std::move(*ready));
        if (waiting_.empty() && ended_) co_return *ended_;
        co_await wake_.wait(waiting_.empty() ? Clock::time_point::max() : waiting_.front().until);
    }
    co_return end_when_stopped();
}

/// Returns the next scan with a known pose; skips scans that will have none.
std::optional<Observation> LidarLive::State::take_ready() {
    while (!waiting_.empty()) {
        const Answer answer = pose_for(waiting_.front());
        if (!answer.is_final) return std::nullopt;
        Observation taken = std::move(waiting_.front().taken);
        waiting_.pop_front();
        if (answer.pose) {
            set_pose(taken.scan, options_.kind, *answer.pose);
            ++given_;
            return taken;
        }
        ++losses_.without_pose;
        report_other_clock(taken.scan.stamp);
    }
    return std::nullopt;
}

/// Reports poses whose clock has another origin. Without the message they would be skipped silently forever.
void LidarLive::State::report_other_clock(double stamp) {
    const auto& timeline = std::get<PoseTimeline>(options_.poses);
    if (timeline.empty() || other_clock_reported_) return;
    const double newest = timeline.newest().stamp;
    if (std::max(stamp - newest, timeline.oldest().stamp - stamp) <= kOtherClock) return;
    other_clock_reported_ = true;
    options_.device.note(fmt::format("scans are skipped: the poses are at t = {:.0f}, and the scans at t = {:.0f}; for "
                                     "a device t is Unix time in seconds",
                                     newest, stamp));
}

/// Returns an error if there were scans and none had a pose, although stop() was requested.
Result<std::optional<Observation>> LidarLive::State::end_when_stopped() const {
    if (given_ > 0 || losses_.without_pose == 0) return std::optional<Observation>{};
    return Error{Errc::kNotFound, fmt::format("no scan was sent: none of {} scans is within the time range of the "
                                              "poses; for a device the t of --pose-file is Unix time in seconds",
                                              losses_.without_pose)};
}

LidarLive::State::Answer LidarLive::State::pose_for(const Waiting& waiting) const {
    if (const auto* fixed = std::get_if<Pose2>(&options_.poses)) return {*fixed};
    const auto& timeline = std::get<PoseTimeline>(options_.poses);
    const double stamp = waiting.taken.scan.stamp;
    if (const auto pose = timeline.at(stamp)) return {*pose};
    const bool is_after_all = timeline.empty() || stamp > timeline.newest().stamp;
    if (!is_after_all) return {};
    if (are_poses_coming_ && Clock::now() < waiting.until) return {std::nullopt, false};
    if (are_poses_coming_ && !timeline.empty() && stamp - timeline.newest().stamp <= seconds(options_.pose_age_max)) {
        return {timeline.newest().robot};
    }
    return {};
}

void LidarLive::State::stop() {
    is_stopped_ = true;
    stop_.notify();
    wake_.notify();
}

// ---------------------------------------------------------------------------------------------------------------------

LidarLive::LidarLive(LidarLiveOptions options) : state_(std::make_shared<State>(std::move(options))) {}

LidarLive::~LidarLive() { state_->stop(); }

asio::awaitable<Result<std::optional<Observation>>> LidarLive::next() { return state_->next(); }

void LidarLive::stop() { state_->stop(); }

std::string LidarLive::remarks() const { return state_->remarks(); }

} // namespace scanloom::robot
