#pragma once

#include "common/scan/poses.hpp"
#include "robot_client/foxglove/bridge_link.hpp"
#include "robot_client/foxglove/robot_publisher.hpp"
#include "robot_client/ros/live_scans.hpp"
#include "robot_client/sources/live_source.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

struct FoxgloveSourceOptions {
    BridgeLinkOptions link;
    LiveScanOptions scans;
    RobotPublisherOptions publish;
    std::chrono::milliseconds waiting_noted_after{5'000}; ///< before the first scan
    std::chrono::milliseconds silent_noted_after{10'000}; ///< since the newest scan
};

/// A robot that runs foxglove_bridge, live: the scans of its laser topics, as LiveScans takes them from messages of ROS
/// 1 or ROS 2. If asked, it publishes back (see RobotPublisher).
///
/// From prepare() on, the bridge is read continuously on that executor, whether or not next() is called. A connection
/// that fails is replaced (see read_bridge()). Stamps are those of the messages, on the robot's clock.
///
/// Threads: as for LiveSource.
class FoxgloveSource final : public LiveSource {
public:
    explicit FoxgloveSource(FoxgloveSourceOptions options);
    FoxgloveSource(const FoxgloveSource&) = delete;
    FoxgloveSource& operator=(const FoxgloveSource&) = delete;
    ~FoxgloveSource() override;

    /// States what the poses of the robot must be, before prepare() and next().
    void expect_poses(Poses poses);

    /// Connects and surveys the robot until it is known what its poses are. Call it once, before next(), which
    /// otherwise does so.
    /// @return what the poses of the scans are
    /// Errors: those of read_bridge() and LiveScans::choose(); those of RobotPublisher::check().
    [[nodiscard]] boost::asio::awaitable<Result<Poses>> prepare();

    /// Errors: those of read_bridge(), once all scans are taken; those of prepare().
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

    /// Sets the transform to publish.
    /// @param T_map_odom  the server's newest correction; nullopt: the robot is not located in the map
    void correct(const std::optional<Pose2>& T_map_odom);

    /// Returns the number of scans that were skipped, by the reason.
    [[nodiscard]] const std::map<std::string, std::uint64_t>& skipped() const;
    /// Returns the number of gaps in the stamps of the lasers and of frames that were refused.
    [[nodiscard]] std::uint64_t lost_parts() const;

private:
    class State;

    std::shared_ptr<State> state_; // shared with the reading coroutines, which may end later
};

} // namespace scanloom::robot
