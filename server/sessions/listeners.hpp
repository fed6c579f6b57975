#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/poses.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace scanloom::sessions {

/// Where a robot is whose poses the server estimates, by its newest scan.
struct Located {
    Pose2 T_map_odom;            ///< of its odometry frame; for Poses::kNone the robot itself is that frame
    Revision revision = 0;       ///< of the maps that contain the scan
    double inlier_ratio = 0.0;   ///< of the scan's points, those that fit the map, 0 to 1
    double position_sigma = 0.0; ///< metres, of the scan's pose, in the most uncertain direction
    double yaw_sigma = 0.0;      ///< radians, of the scan's pose
    LocalizationState state = LocalizationState::kGiven;
    std::optional<double> mount_yaw_error; ///< radians: by how much the yaw of the laser's mount seems to be too large
};

/// Receives acknowledgements, corrections and errors for a robot's link. Called on the session's strand: must not
/// block.
class RobotListener {
public:
    virtual ~RobotListener() = default;

    /// Acknowledges scans.
    /// @param durable_seq  every scan up to this number is in the log and in the maps
    /// @param bytes  credit returned for submitted data, in addition to earlier calls
    virtual void on_durable(std::uint64_t durable_seq, std::size_t bytes) = 0;

    /// Reports where the robot is, after scans of it are in the maps. Not called for robots that send poses.
    virtual void on_located(const Located& located) { static_cast<void>(located); }

    /// Reports the error with which the session has closed this link. It accepts no further data from it.
    virtual void on_failed(const Error& error) = 0;
};

/// A robot that joins a session, from the fields of its Hello.
struct JoinRequest {
    std::string robot;
    std::string source = {};                ///< Hello.source
    std::optional<double> body_radius = {}; ///< metres
    Poses poses = Poses::kMap;              ///< Hello.poses
};

/// The result of joining a session.
struct Joined {
    RobotIndex robot = 0;
    std::uint64_t last_durable_seq = 0;
    std::set<std::uint32_t> sensors = {}; ///< sensors that the robot has described, on this or earlier links
};

/// Interface that is notified when the visible state of a session has changed: its maps, the links of its robots, its
/// closing or failure, or data that other components keep about the session.
class Watcher {
public:
    virtual ~Watcher() = default;

    /// Called after a change, possibly often, on the session's strand or on any other thread. Must not block.
    virtual void on_changed() noexcept = 0;
};

/// The watchers of a session, held by weak pointers.
///
/// Their number is not limited here: the callers that admit watchers limit it.
/// Cost: one call of on_changed() per watcher and notification.
/// Threads: any thread.
class Watchers {
public:
    void add(std::weak_ptr<Watcher> watcher) {
        const std::lock_guard lock(mutex_);
        remove_expired();
        watchers_.push_back(std::move(watcher));
    }

    /// Calls on_changed() of each watcher.
    void notify() {
        const std::lock_guard lock(mutex_);
        bool any_gone = false;
        for (const auto& watcher : watchers_) {
            const auto present = watcher.lock();
            if (present) present->on_changed();
            any_gone = any_gone || !present;
        }
        if (any_gone) remove_expired();
    }

private:
    void remove_expired() {
        std::erase_if(watchers_, [](const auto& watcher) { return watcher.expired(); });
    }

    std::mutex mutex_;
    std::vector<std::weak_ptr<Watcher>> watchers_;
};

} // namespace scanloom::sessions
