#pragma once

#include "common/error/error.hpp"
#include "core/localization/localized_projection.hpp"
#include "core/mapping/projection.hpp"
#include "core/mapping/scan_poses.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <cstddef>
#include <utility>

namespace scanloom::sessions {

/// Makes the maps of a session again from its log, with corrected poses of the scans that robots sent without.
/// Threads: one at a time, which may wait for the disk.
class MapCorrection {
public:
    /// @param log      of the session, which is read
    /// @param session  its id
    /// @param shown    the session's maps, whose settings and exclusions it takes
    /// @param poses    at which the maps show scans
    /// @param as_of    the newest entry at which these poses were corrected
    MapCorrection(store::ScanLog& log, store::SessionId session, const mapping::Projection& shown,
                  mapping::ScanPoses poses, Revision as_of)
        : log_(log), session_(session), projection_(shown.config(), shown.exclusions()), poses_(std::move(poses)),
          as_of_(as_of) {}

    /// Returns the revision of the newest applied entry.
    [[nodiscard]] Revision revision() const noexcept { return projection_.revision(); }

    /// Returns SessionPoses::corrected() of its poses.
    [[nodiscard]] Revision as_of() const noexcept { return as_of_; }

    /// Returns the memory of the maps so far; see mapping::Projection::page_count().
    [[nodiscard]] std::size_t page_count() const noexcept { return projection_.page_count(); }

    /// Takes the poses of more scans than before, for the entries that were not applied yet.
    void set_poses(mapping::ScanPoses poses) { poses_ = std::move(poses); }

    /// Applies entries of the log up to `target`, or a part of them.
    /// @param work  budget in the unit of Reach::work; reduced by the work that was done
    /// @param stop  checked before each entry
    /// Errors: those of ScanLog::read() and recover(); kOverloaded if memory runs out; kShuttingDown if `stop` is true.
    [[nodiscard]] Result<> apply_up_to(Revision target, double& work, const std::atomic<bool>& stop);

    /// Returns the maps.
    [[nodiscard]] mapping::Projection take() && { return std::move(projection_); }

private:
    store::ScanLog& log_;
    store::SessionId session_;
    mapping::Projection projection_;
    mapping::ScanPoses poses_;
    Revision as_of_;
};

/// Makes recovered maps follow the corrected poses, unless the log has not announced these.
/// Errors: those of MapCorrection::apply_up_to().
[[nodiscard]] Result<> correct_as_announced(store::ScanLog& log, store::SessionId session,
                                            localization::LocalizedProjection& maps, const std::atomic<bool>& stop);

} // namespace scanloom::sessions
