#pragma once

#include "common/error/error.hpp"
#include "server/guide/first_places.hpp"
#include "server/landmarks/localization.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session.hpp"

#include <functional>
#include <optional>

namespace scanloom::guide {

/// A robot that was found.
struct Located {
    landmarks::Alignment alignment; ///< clear; T_first_second is T_map_odom
    Revision revision = 0;          ///< of the log entries that it was found in
};

/// Tells robots where they are, by what they see and what the session's lasers have seen: what no other place explains
/// as well, or nothing.
/// Thread  any that may wait for the disk.
class Locator {
public:
    explicit Locator(store::ScanLog& log) : folds_(log) {}

    /// @param robot  who asks
    /// @param view   what the robot sees, odometry frame
    /// @param near   where in the map to look; none: everywhere
    /// @param ask    now and then; its error ends it
    /// Errors  kAmbiguous, kUndetermined: the map does not tell, and the message says why; those of landmarks::locate(),
    ///         CaptureFolds::up_to() and of `ask`.
    ///         kNothingMapped is for one robot at a time (see FirstPlaces), and kOverloaded meanwhile for all others.
    [[nodiscard]] Result<Located> locate(const session::Session& session, RobotIndex robot,
                                         const landmarks::CloudView& view,
                                         const std::optional<landmarks::Neighbourhood>& near,
                                         const std::function<Result<>()>& ask);

    /// The session is deleted: forgets it.
    void remove(store::SessionId session);

private:
    session::ReferenceFolds folds_;
    FirstPlaces first_places_;
};

} // namespace scanloom::guide
