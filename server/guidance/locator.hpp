#pragma once

#include "common/error/error.hpp"
#include "core/landmarks/localization.hpp"
#include "server/guidance/map_start.hpp"
#include "server/sessions/capture_layers.hpp"
#include "server/sessions/session.hpp"

#include <functional>
#include <optional>

namespace scanloom::guide {

/// The pose that was found for a robot.
struct Located {
    landmarks::Alignment alignment; ///< of certainty kClear; T_first_second is T_map_odom
    Revision revision = 0;          ///< of the map's last log entry that the search used
};

/// Localizes robots in the map of their session by comparing what they see with what the session's lasers have seen. A
/// pose is returned only if no other place matches as well.
/// Threads: any thread that may wait for the disk.
class Locator {
public:
    explicit Locator(store::ScanLog& log) : folds_(log) {}

    /// Finds the pose of a robot in the map of its session.
    /// @param robot  the robot to localize
    /// @param view   what the robot sees, odometry frame
    /// @param near   where in the map to search; nullopt: everywhere
    /// @param ask    called from time to time; an error that it returns ends the search
    /// Errors: kAmbiguous or kUndetermined if the map does not determine the pose; the message says why. kNothingMapped
    ///     if nothing is mapped yet and this robot may start the map; kOverloaded if another robot may (see
    ///     MapStart). Those of landmarks::locate(), CaptureLayers::up_to() and `ask`.
    [[nodiscard]] Result<Located> locate(const session::Session& session, RobotIndex robot,
                                         const landmarks::CloudView& view,
                                         const std::optional<landmarks::Neighbourhood>& near,
                                         const std::function<Result<>()>& ask);

    /// Forgets a session that was deleted.
    void remove(store::SessionId session);

private:
    session::ReferenceLayers folds_;
    MapStart first_places_;
};

} // namespace scanloom::guide
