#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "core/landmarks/localization.hpp"
#include "server/sessions/capture_layers.hpp"
#include "server/sessions/session.hpp"

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

namespace scanloom::guidance {

/// Decides which robot starts the map of a session in which nothing is mapped yet, if several robots ask for their
/// pose.
///
/// The robot that starts the map stands where its operator says. If two robots started a map at the same time, the
/// transform between their poses would be unknown.
/// Threads: any thread.
class MapStart {
public:
    using Clock = std::chrono::steady_clock;

    /// How long a robot that sends nothing prevents other robots from starting the map.
    static constexpr std::chrono::seconds kKept{30};

    /// Returns whether the robot may start the map. It may unless another robot was allowed to within the last kKept.
    [[nodiscard]] bool take(store::SessionId session, RobotIndex robot, Clock::time_point now);

    /// Forgets a session that was deleted.
    void remove(store::SessionId session);

private:
    struct Taken {
        RobotIndex robot;
        Clock::time_point until;
    };

    std::mutex mutex_;
    std::map<store::SessionId, Taken> taken_; // of sessions in which nothing is mapped, and for kKept after that
};

/// The pose that was found for a robot.
struct LocateResult {
    landmarks::Alignment alignment; ///< of certainty kClear; T_first_second is T_map_odom
    Revision revision = 0;          ///< of the map's last log entry that the search used
};

/// Localizes robots in the map of their session by comparing what they see with what the session's lasers have seen. A
/// pose is returned only if no other place matches as well.
/// Threads: any thread that may wait for the disk.
class Locator {
public:
    explicit Locator(store::ScanLog& log) : reference_layers_(log) {}

    /// Finds the pose of a robot in the map of its session.
    /// @param robot  the robot to localize
    /// @param view   what the robot sees, odometry frame
    /// @param near   where in the map to search; nullopt: everywhere
    /// @param ask    called from time to time; an error that it returns ends the search
    /// Errors: kAmbiguous or kUndetermined if the map does not determine the pose; the message says why. kNothingMapped
    ///     if nothing is mapped yet and this robot may start the map; kOverloaded if another robot may (see
    ///     MapStart). Those of landmarks::locate(), CaptureLayers::up_to() and `ask`.
    [[nodiscard]] Result<LocateResult> locate(const sessions::Session& session, RobotIndex robot,
                                              const landmarks::CloudView& view,
                                              const std::optional<landmarks::Neighbourhood>& near,
                                              const std::function<Result<>()>& ask);

    /// Forgets a session that was deleted.
    void remove(store::SessionId session);

private:
    sessions::ReferenceLayers reference_layers_;
    MapStart first_places_;
};

} // namespace scanloom::guidance
