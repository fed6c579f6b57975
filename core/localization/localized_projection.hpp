#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "core/localization/session_poses.hpp"
#include "core/mapping/projection.hpp"

#include <cstddef>
#include <utility>

namespace scanloom::localization {

/// The maps of a session, with the poses of the scans that robots send without.
///
/// When SessionPoses corrects the poses of earlier scans, the maps still show them where they were: is_outdated(). The
/// maps of the same entries at the corrected poses must then be made from the log; replace() takes them.
/// Threads: one at a time; snapshots of the projection as there.
class LocalizedProjection {
public:
    /// @param projection  of a log without scans that robots sent without poses
    LocalizedProjection(
        mapping::Projection projection) // NOLINT(google-explicit-constructor): most logs are of this kind
        : projection_(std::move(projection)) {
        poses_.change_mode(projection_.is_localize_only(), projection_.revision());
    }

    /// @param projection  of a log up to an entry
    /// @param poses       of the same entries
    /// @param shown       SessionPoses::corrected() of the poses in the maps
    /// @param announced   see announced()
    LocalizedProjection(mapping::Projection projection, SessionPoses poses, Revision shown, Revision announced)
        : projection_(std::move(projection)), poses_(std::move(poses)), estimated_(projection_.revision()),
          shown_(shown), announced_(announced) {}

    /// Returns the maps.
    [[nodiscard]] const mapping::Projection& projection() const noexcept { return projection_; }
    /// Returns the maps, to take snapshots of them.
    [[nodiscard]] mapping::Projection& projection() noexcept { return projection_; }
    /// Returns the estimated poses of the scans.
    [[nodiscard]] const SessionPoses& poses() const noexcept { return poses_; }

    /// Returns the memory use in pages: that of the maps, and of the poses one for each keyframe, with its share of
    /// what scans are matched to, and kScanBytes for each scan.
    [[nodiscard]] std::size_t page_count() const noexcept { return projection_.page_count() + pages_of_poses(); }

    /// Returns the state of the maps for a checkpoint, with the pages of the poses; see mapping::Projection::state().
    [[nodiscard]] mapping::ProjectionState state() const {
        mapping::ProjectionState state = projection_.state();
        state.pages += pages_of_poses();
        return state;
    }

    /// Applies the next entry of the log, or a part of it; see mapping::Projection::apply().
    /// @param entry  as in the log in the first call; a scan without a pose gets its estimated pose, unless it is
    ///               excluded: then the poses of the others are estimated as if it were not in the log
    /// @param work  budget in the unit of Reach::work; reduced by the work that was done
    /// @return whether the entry is completely applied
    /// Errors: those of mapping::Projection::apply(). After an error, the poses may contain the scan already.
    [[nodiscard]] Result<bool> apply(LogEntry& entry, double& work);

    /// Returns whether the maps show scans at poses that have been corrected.
    [[nodiscard]] bool is_outdated() const noexcept { return shown_ < poses_.corrected(); }

    /// Returns SessionPoses::corrected() of the poses in the maps.
    [[nodiscard]] Revision shown() const noexcept { return shown_; }

    /// Returns MapsCorrected::as_of of the newest such entry; 0 if there is none.
    [[nodiscard]] Revision announced() const noexcept { return announced_; }

    /// Returns how well the poses of a robot are known.
    /// @param robot  index in the session
    [[nodiscard]] mapping::Localization localization_of(RobotIndex robot) const {
        if (projection_.robots()[robot].poses == Poses::kMap) return {};
        const RobotPoses* poses = poses_.find(robot);
        return poses == nullptr ? mapping::Localization{.state = LocalizationState::kUnlocated} : poses->localization();
    }

    /// Returns the number of scans that the maps do not show at their corrected poses; 0 if they are not outdated.
    [[nodiscard]] std::size_t moving_scans() const noexcept { return is_outdated() ? poses_.scan_count() : 0; }

    /// Makes the maps those of the same entries at corrected poses; see mapping::Projection::replace_with().
    /// @param corrected  the maps of all entries up to projection().revision()
    /// @param as_of      SessionPoses::corrected() when its poses were taken
    void replace(mapping::Projection corrected, Revision as_of) {
        projection_.replace_with(std::move(corrected));
        shown_ = as_of;
    }

private:
    static constexpr std::size_t kScanBytes = 250;

    void begin();
    [[nodiscard]] std::size_t pages_of_poses() const noexcept {
        return poses_.map().graph().size() + poses_.scan_count() * kScanBytes / mapping::kPageBytes;
    }

    mapping::Projection projection_;
    SessionPoses poses_;
    Revision estimated_ = 0; // newest entry whose pose is estimated; it may be applied in part
    Revision shown_ = 0;     // SessionPoses::corrected() of the poses in the maps
    Revision announced_ = 0;
};

} // namespace scanloom::localization
