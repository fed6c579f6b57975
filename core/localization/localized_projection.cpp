#include "core/localization/localized_projection.hpp"

#include "core/localization/known_map.hpp"

#include <algorithm>
#include <variant>

namespace scanloom::localization {
namespace {

constexpr double kEstimationWork = 4e5; // of a scan's pose, in the unit of Reach::work: some tenths of a millisecond

} // namespace

Result<bool> LocalizedProjection::apply(LogEntry& entry, double& work) {
    const Revision revision = projection_.revision() + 1;
    auto* taken = std::get_if<ScanTaken>(&entry);
    const bool is_estimated = taken != nullptr && taken->robot < projection_.robots().size() &&
                              projection_.robots()[taken->robot].poses != Poses::kMap;
    if (is_estimated && estimated_ < revision) {
        if (auto follows = projection_.check(entry); !follows) return follows.error();
        if (projection_.exclusions()->cover(revision, scan_pose_of(*taken))) {
            poses_.leave_out(*taken, revision);
        } else {
            if (poses_.scan_count() == 0) begin();
            poses_.estimate(*taken, *projection_.sensor_of(taken->robot, taken->scan.sensor), revision);
            work -= kEstimationWork;
        }
        estimated_ = revision;
    }
    auto applied = projection_.apply(entry, work);
    if (!applied || !*applied) return applied;
    if (taken != nullptr && !is_estimated && !projection_.has_left_out_newest(taken->robot)) {
        poses_.add_given(*taken, *projection_.sensor_of(taken->robot, taken->scan.sensor));
    }
    if (const auto* changed = std::get_if<ModeChanged>(&entry)) {
        if (poses_.scan_count() > 0 && !poses_.is_frame_given()) begin(); // before a sender's first scan that is mapped
        poses_.change_mode(changed->is_localize_only, revision);
    }
    if (const auto* relocalized = std::get_if<RobotRelocalized>(&entry)) poses_.relocalize(*relocalized);
    if (const auto* corrected = std::get_if<MapsCorrected>(&entry)) announced_ = corrected->as_of;
    return true;
}

/// Begins to estimate poses, in the frame of the maps if they have one.
void LocalizedProjection::begin() {
    const FrameOrigin frame = projection_.frame_origin();
    if (frame != FrameOrigin::kImported && frame != FrameOrigin::kSent) return;
    const auto sends = [](const LoggedRobot& robot) { return robot.poses == Poses::kMap && robot.last_seq > 0; };
    const bool is_imported = std::ranges::none_of(projection_.robots(), sends);
    poses_.begin_with(views_of(projection_.snapshot().classes, projection_.config().cell_size), is_imported);
}

} // namespace scanloom::localization
