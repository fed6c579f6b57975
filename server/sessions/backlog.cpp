#include "server/sessions/backlog.hpp"

#include <iterator>
#include <map>
#include <utility>

namespace scanloom::sessions {

Group Backlog::next_group(std::int64_t room) {
    Group group;
    // The scans of one robot and kind of sensor mostly overlap, so one box for all of them is a tight bound.
    std::map<std::pair<RobotIndex, SensorKind>, grid::CellBox> boxes;
    while (!waiting_.empty() && group.entries.size() < kGroupEntriesMax) {
        const PendingEntry& next = waiting_.front();
        if (!group.entries.empty() && group.work + next.reach.work > kGroupWorkMax) break;
        auto& box = boxes[{next.robot, next.reach.kind}];
        auto grown = box;
        grown.include(next.reach.cells);
        const auto chunks = group.chunks - mapping::chunk_count_of(box) + mapping::chunk_count_of(grown);
        if (chunks > room && !next.reach.cells.empty()) break;
        box = grown;
        group.chunks = chunks;
        group.work += next.reach.work;
        group.entries.push_back(std::move(waiting_.front()));
        waiting_.pop_front();
    }
    return group;
}

void Backlog::put_back(Group group) {
    waiting_.insert(waiting_.begin(), std::make_move_iterator(group.entries.begin()),
                    std::make_move_iterator(group.entries.end()));
}

void Backlog::drop(RobotIndex robot) {
    std::erase_if(waiting_, [robot](const PendingEntry& entry) { return entry.robot == robot; });
}

} // namespace scanloom::sessions
