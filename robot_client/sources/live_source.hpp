#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/sources/source.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// Pose of a robot's odometry frame in the map, with its uncertainty.
struct LocateResult {
    Pose2 T_map_odom;
    double inlier_ratio = 0.0;   ///< share of the observed points that match the map, 0 to 1
    double position_sigma = 0.0; ///< metres; standard deviation in the least certain direction
    double yaw_sigma = 0.0;      ///< radians
};

/// Requests the position of a robot that saw these points from this place, both in its odometry frame, on maps that
/// contain all its scans so far.
/// Pre: 20 to 32,768 points.
using Locate = std::function<boost::asio::awaitable<Result<LocateResult>>(std::vector<PointMm> points, Point2 from)>;

/// The next exploration goal of a robot.
struct NextStop {
    enum class Outcome {
        kGoal,          ///< `path` leads to the next goal
        kTakenByOthers, ///< other robots drive to all goals that this robot can reach
        kComplete,      ///< no goal can be reached any more
    };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path; ///< with kGoal: path to the goal, metres in the map frame
    Point2 target{0.0, 0.0};  ///< with kGoal: the point to observe from the end of the path
};

/// Requests the next goal of a robot at the pose of its newest scan, on maps that contain all its scans so far. Paths
/// should keep the distance from obstacles that the robot needs to follow them.
using NextGoal = std::function<boost::asio::awaitable<Result<NextStop>>()>;

/// A source whose scans arrive at their own time: a sensor, or a robot that waits for replies. Its scans cannot be
/// obtained again.
///
/// Every scan and sensor keeps common/scan/limits.hpp, as for Source.
/// Threads: that of the executor which awaits next().
class LiveSource {
public:
    virtual ~LiveSource() = default;

    /// Waits for the next scan and returns it, or nullopt when there are no more.
    /// Errors: the sensor's, if it cannot be read any more.
    [[nodiscard]] virtual boost::asio::awaitable<Result<std::optional<Observation>>> next() = 0;

    /// Returns whether the source's time stands still between calls of next(), as in a simulation. Then waiting loses
    /// nothing.
    [[nodiscard]] virtual bool can_wait() const { return false; }
    /// Sets the number of this source's scans that the server has from earlier runs. Only if can_wait(), before the
    /// first next().
    virtual void resume_after(std::uint64_t scans) { static_cast<void>(scans); }

    /// Ends the source: a pending next() returns soon, and later calls return nullopt, or an error if no scan could be
    /// obtained.
    virtual void stop() = 0;

    /// Returns a few words for people about the source, in addition to its scans; may be empty.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

/// A recording replayed as a live source. Its time stands still between calls of next(). It starts at its beginning,
/// whatever the server has from earlier runs.
///
/// Threads: as for LiveSource.
class ReplayedSource final : public LiveSource {
public:
    explicit ReplayedSource(std::unique_ptr<Source> recording) : recording_(std::move(recording)) {}

    /// Errors: those of the recording.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override {
        co_await boost::asio::post(co_await boost::asio::this_coro::executor,
                                   boost::asio::use_awaitable); // lets other handlers of the thread run
        if (is_stopped_) co_return std::optional<Observation>{};
        co_return recording_->next();
    }
    [[nodiscard]] bool can_wait() const override { return true; }
    void stop() override { is_stopped_ = true; }
    [[nodiscard]] std::string remarks() const override { return recording_->remarks(); }

private:
    std::unique_ptr<Source> recording_;
    bool is_stopped_ = false;
};

} // namespace scanloom::robot
