#include "server/sessions/session_maps.hpp"

#include "core/mapping/snapshot.hpp"

#include <new>
#include <utility>
#include <variant>

namespace scanloom::sessions {
namespace {

Error no_memory() {
    return {Errc::kOverloaded, "there is no memory left for this map; use larger cells or another session"};
}

/// Returns the maps that are published if memory runs out while the session's maps are withdrawn.
const std::shared_ptr<const mapping::Snapshot>& no_maps() {
    static const auto none = std::make_shared<const mapping::Snapshot>();
    return none;
}

} // namespace

SessionMaps::SessionMaps(mapping::Projection projection) : projection_(std::move(projection)) {
    static_cast<void>(no_maps()); // create it while there is memory
    if (!publish()) throw std::bad_alloc();
}

Result<bool> SessionMaps::apply(LogEntry& entry, double& work) {
    try {
        const auto applied = projection_.apply(entry, work);
        auto* taken = std::get_if<ScanTaken>(&entry);
        if (!applied || !*applied || taken == nullptr || projection_.has_left_out_newest(taken->robot)) return applied;
        if (newest_scans_.size() <= taken->robot) newest_scans_.resize(taken->robot + 1);
        newest_scans_[taken->robot] = std::make_shared<const mapping::IntegratedScan>(mapping::IntegratedScan{
            projection_.revision(), projection_.sensor_of(taken->robot, taken->scan.sensor), std::move(taken->scan)});
        return true;
    } catch (const std::bad_alloc&) {
        return no_memory();
    }
}

Result<> SessionMaps::publish() {
    try {
        auto maps = projection_.snapshot();
        for (std::size_t n = 0; n < newest_scans_.size(); ++n) maps.robots[n].newest_scan = newest_scans_[n];
        published_.set(std::make_shared<const mapping::Snapshot>(std::move(maps)));
        return {};
    } catch (const std::bad_alloc&) {
        published_.fall_back_to(no_maps());
        return no_memory();
    }
}

} // namespace scanloom::sessions
