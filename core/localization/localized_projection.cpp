#include "core/localization/localized_projection.hpp"

#include "core/localization/known_map.hpp"

#include <variant>

namespace scanloom::localization {
namespace {

constexpr double kEstimationWork = 4e5; // of a scan's pose, in the unit of Reach::work: some tenths of a millisecond

} // namespace

Result<bool> LocalizedProjection::apply(LogEntry& entry, double& work) {
    const Revision revision = projection_.revision() + 1;
    auto* taken = std::get_if<ScanTaken>(&entry);
    if (taken != nullptr && estimated_ < revision && taken->robot < projection_.robots().size() &&
        projection_.robots()[taken->robot].poses != Poses::kMap) {
        if (auto follows = projection_.check(entry); !follows) return follows.error();
        if (poses_.scan_count() == 0 && projection_.chunk_count() > 0) {
            poses_.begin_with(views_of(projection_.snapshot().classes, projection_.config().cell_size));
        }
        poses_.estimate(*taken, *projection_.sensor_of(taken->robot, taken->scan.sensor), revision);
        estimated_ = revision;
        work -= kEstimationWork;
    }
    const auto applied = projection_.apply(entry, work);
    if (const auto* changed = std::get_if<ModeChanged>(&entry); applied && *applied && changed != nullptr) {
        poses_.change_mode(changed->is_localize_only, revision);
    }
    if (const auto* relocalized = std::get_if<RobotRelocalized>(&entry);
        applied && *applied && relocalized != nullptr) {
        poses_.relocalize(*relocalized);
    }
    const auto* corrected = std::get_if<MapsCorrected>(&entry);
    if (applied && *applied && corrected != nullptr) announced_ = corrected->as_of;
    return applied;
}

} // namespace scanloom::localization
