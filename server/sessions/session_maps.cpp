#include "server/sessions/session_maps.hpp"

#include "core/mapping/snapshot.hpp"

#include <cmath>
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

SessionMaps::SessionMaps(localization::LocalizedProjection maps) : maps_(std::move(maps)) {
    static_cast<void>(no_maps()); // create it while there is memory
    if (!publish()) throw std::bad_alloc();
}

Result<bool> SessionMaps::apply(LogEntry& entry, double& work) {
    try {
        const auto applied = maps_.apply(entry, work);
        if (!applied || !*applied) return applied;
        if (const auto* corrected = std::get_if<MapsCorrected>(&entry)) {
            if (!correction_ || correction_->as_of() != corrected->as_of) return true;
            if (auto done = correct(); !done) return done.error();
        }
        auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken == nullptr || projection().has_left_out_newest(taken->robot)) return true;
        if (newest_scans_.size() <= taken->robot) newest_scans_.resize(taken->robot + 1);
        auto& newest = newest_scans_[taken->robot];
        std::erase_if(newest, [&](const auto& scan) { return scan->scan.sensor == taken->scan.sensor; });
        newest.push_back(std::make_shared<const mapping::IntegratedScan>(
            mapping::IntegratedScan{projection().revision(), projection().sensor_of(taken->robot, taken->scan.sensor),
                                    std::move(taken->scan)}));
        return true;
    } catch (const std::bad_alloc&) {
        return no_memory();
    }
}

/// Replaces the maps by those at the corrected poses.
Result<> SessionMaps::correct() {
    auto correction = std::exchange(correction_, nullptr);
    correction->set_poses(maps_.poses().in_maps());
    double work = HUGE_VAL;
    if (auto applied = correction->apply_up_to(projection().revision(), work, false); !applied) return applied;
    const Revision as_of = correction->as_of();
    maps_.replace(std::move(*correction).take(), as_of);
    move_newest_scans();
    return {};
}

/// Gives the newest scans the poses at which the maps show them.
void SessionMaps::move_newest_scans() {
    const auto poses = maps_.poses().in_maps();
    for (RobotIndex robot = 0; robot < newest_scans_.size(); ++robot) {
        for (auto& newest : newest_scans_[robot]) {
            const auto pose = poses.find(robot, newest->scan.seq);
            if (!pose || newest->scan.pose == pose) continue;
            auto moved = *newest;
            moved.scan.pose = pose;
            newest = std::make_shared<const mapping::IntegratedScan>(std::move(moved));
        }
    }
}

Result<> SessionMaps::publish() {
    try {
        auto maps = maps_.projection().snapshot();
        maps.moving_scans = maps_.moving_scans();
        for (std::size_t n = 0; n < newest_scans_.size(); ++n) {
            if (newest_scans_[n].empty()) continue;
            maps.robots[n].newest_scan = newest_scans_[n].back();
            maps.robots[n].newest_scans = newest_scans_[n];
        }
        for (RobotIndex n = 0; n < maps.robots.size(); ++n) {
            maps.robots[n].localization = maps_.localization_of(n);
        }
        published_.set(std::make_shared<const mapping::Snapshot>(std::move(maps)));
        return {};
    } catch (const std::bad_alloc&) {
        published_.fall_back_to(no_maps());
        return no_memory();
    }
}

} // namespace scanloom::sessions
