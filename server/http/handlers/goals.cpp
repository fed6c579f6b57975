#include "server/http/handlers/goals.hpp"

#include "common/scan/limits.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/number.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

std::string_view name_of(guide::WayKind kind) {
    switch (kind) {
    case guide::WayKind::kGoal: return "goal";
    case guide::WayKind::kPlan: return "plan";
    case guide::WayKind::kCoverage: return "coverage";
    }
    return "";
}

std::string feature_of(const std::string& robot, const guide::Way& way) {
    const boost::json::object properties{{"role", "way"},
                                         {"robot", robot},
                                         {"kind", name_of(way.kind)},
                                         {"length", rounded_metres(way.length_m)},
                                         {"points_left_out", way.points_left_out},
                                         {"revision", way.revision}};
    return feature(properties, line_string(way.points));
}

std::string feature_of(const std::string& robot, const guide::Goal& goal) {
    const boost::json::object properties{{"role", "goal"},
                                         {"robot", robot},
                                         {"target", position(goal.target)},
                                         {"in_danger", goal.in_danger},
                                         {"revision", goal.revision}};
    return feature(properties, point_geometry(goal.place));
}

} // namespace

Result<Response> get_goals(session::SessionRegistry& sessions, guide::WayBook& ways, const AnswerSlots& slots,
                           const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();

    const auto page = ways.page(*session, guide::WayBook::Clock::now());
    std::size_t bytes = page.explored.size() * kNameBytesMax;
    for (const auto& held : page.robots) bytes += ((held.way ? held.way->points.size() : 0) + 16) * kPointTextBytes;
    auto slot = slots.take(bytes);
    if (!slot) return slot.error();

    const auto maps = (*session)->snapshot();
    std::vector<std::string> features;
    for (const auto& held : page.robots) {
        if (held.robot >= maps->robots.size()) continue; // its join has not been applied to the maps yet
        const std::string& name = maps->robots[held.robot].name;
        if (held.way) features.push_back(feature_of(name, *held.way));
        if (held.goal) features.push_back(feature_of(name, *held.goal));
    }
    boost::json::array explored;
    for (const RobotIndex robot : page.explored) {
        if (robot < maps->robots.size()) explored.emplace_back(maps->robots[robot].name);
    }
    return ok_text(kGeoJson, std::move(*slot),
                   collection_document(page.revision, {{"explored", std::move(explored)}}, features));
}

} // namespace scanloom::http
