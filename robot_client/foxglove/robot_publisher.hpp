#pragma once

#include "common/error/error.hpp"
#include "common/net/http_connection.hpp"
#include "robot_client/foxglove/core/bridge_session.hpp"
#include "robot_client/ros/frame_choice.hpp"
#include "robot_client/ros/outgoing_messages.hpp"
#include "robot_client/ros/robot_clock.hpp"
#include "robot_client/sources/wake_signal.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Where the map of a session is downloaded from.
struct MapPlace {
    net::HttpPlace http;
    std::string session;
};

struct RobotPublisherOptions {
    std::string map_frame = "map"; ///< name of the server's map frame
    bool transform = false;        ///< publish the transform from the map frame to the odometry frame on /tf
    std::optional<MapPlace> map;   ///< publish this map on /map; none: no map
    std::chrono::milliseconds transform_period{33};
    std::chrono::milliseconds map_period{2'000};    ///< between two looks for a newer map
    std::chrono::milliseconds map_repeated{10'000}; ///< how often an unchanged map is published again
};

/// Publishes back to a robot, through its bridge: the transform from the map to its odometry frame, and the map.
///
/// The transform is published steadily from the newest correction of the server, with the robot's present time, never
/// twice with one stamp. The map is published when it has changed, and again from time to time, because a bridge does
/// not keep it for programs that start later. What waits for a slow connection is replaced by what is newer.
/// Threads: one at a time, those of the executor that runs it.
class RobotPublisher {
public:
    using Note = std::function<void(const std::string&)>;

    /// @param session  of the bridge; must outlive this object, as `to_send`
    /// @param to_send  is notified when there is a frame to send
    /// @param note     receives messages for people
    RobotPublisher(RobotPublisherOptions options, foxglove::BridgeSession& session, WakeSignal& to_send, Note note);

    /// Checks whether everything can be published.
    /// @param frames     that were chosen
    /// @param ancestors  of the fixed frame, itself first
    /// Errors: kConflict if the robot has no odometry, another program publishes the transform, its frames are one, or the
    ///         bridge does not let clients publish. Precondition: the bridge is connected.
    [[nodiscard]] Result<> check(const FrameChoice& frames, const std::vector<std::string>& ancestors) const;

    /// Reports a bridge that does not let clients publish any more.
    void on_connected() const;
    /// Adds the stamp of a message of the robot.
    void add_stamp(RosTime stamp);
    /// Sets the transform to publish; nullopt: none.
    void correct(const std::optional<Pose2>& T_map_odom) { T_map_odom_ = T_map_odom; }

    /// Publishes until it is cancelled.
    /// @param odom_frame  name of the odometry frame
    [[nodiscard]] boost::asio::awaitable<void> run(std::string odom_frame);

private:
    [[nodiscard]] boost::asio::awaitable<void> publish_transforms(const std::string& odom_frame);
    [[nodiscard]] boost::asio::awaitable<void> publish_maps();
    void publish_map(const RosGrid& grid);
    [[nodiscard]] bool is_asked() const { return options_.transform || options_.map; }
    void note_once(const std::string& text);

    RobotPublisherOptions options_;
    foxglove::BridgeSession& session_;
    WakeSignal& to_send_;
    Note note_;
    std::uint32_t transforms_ = 0; // numbers of publications
    std::uint32_t maps_ = 0;
    RobotClock clock_;
    RisingStamps stamps_;
    std::optional<Pose2> T_map_odom_;
    std::string noted_;
};

} // namespace scanloom::robot
