#include "server/http/handlers/plan.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/number.hpp"
#include "server/planning/grid_path.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::array<std::string_view, 5> kMembers = {"from", "to", "allow_unknown", "body_radius", "danger_cost"};

Result<boost::json::object> parse_plan(std::string_view text) {
    auto body = parse_json_object(text);
    if (!body) return body;
    if (auto known = check_members(*body, kMembers); !known) return known.error();
    for (const char* name : {"from", "to"}) {
        if (!body->contains(name)) {
            return Error{Errc::kInvalidField, fmt::format("{} is missing; give [x, y] in metres", name)};
        }
    }
    return body;
}

} // namespace

Result<Response> post_plan(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    const auto found = find_for_search(maps, call, {});
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto body = parse_plan(call.request.body);
    if (!body) return body.error();
    const auto to = read_point(body->at("to"), "to");
    if (!to) return to.error();
    const auto from = read_place(body->at("from"), "from", snapshot);
    if (!from) return from.error();
    const auto options = passability_options(*body, from->body_radius);
    if (!options) return options.error();

    const auto path = planning::plan_path(snapshot.classes, snapshot.config.cell_size, from->point, *to, *options);
    if (!path) return path.error();
    auto slot = slots.take(path->points.size() * kPointTextBytes);
    if (!slot) return slot.error();
    const boost::json::object properties{{"length", rounded_metres(path->length_m)},
                                         {"cost", rounded_metres(path->cost)}};
    return ok_text(kGeoJson, std::move(*slot),
                   feature_document(snapshot.revision, properties, line_string(path->points)));
}

} // namespace scanloom::http
