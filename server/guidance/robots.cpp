#include "server/guidance/robots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace scanloom::guidance {

Result<RobotIndex> find_robot(const mapping::Snapshot& maps, std::string_view name) {
    const auto found = std::ranges::find(maps.robots, name, &mapping::RobotState::name);
    if (found != maps.robots.end()) return static_cast<RobotIndex>(found - maps.robots.begin());
    return Error{Errc::kNotFound, "these maps have no robot of that name; the session lists its robots"};
}

Result<Pose2> pose_of(const mapping::Snapshot& maps, RobotIndex robot) {
    if (robot >= maps.robots.size()) return Error{Errc::kNoPath, "the robot has joined but has sent no scan yet"};
    const auto& state = maps.robots[robot];
    const bool is_lost = state.localization.state == LocalizationState::kLost;
    if (state.pose && !is_lost) return *state.pose;
    const std::string_view why = is_lost               ? "it is lost: its newest scans fit no place in the map"
                                 : state.last_seq == 0 ? "it has sent no scan yet"
                                                       : "its scans are in no map yet; see its localization";
    return Error{Errc::kNoPath, fmt::format("the position of robot '{}' is not known: {}", state.name, why)};
}

} // namespace scanloom::guidance
