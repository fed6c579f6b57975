#include "server/http/handlers/coverage.hpp"

#include "server/guide/patience.hpp"
#include "server/guide/robots.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/number.hpp"
#include "server/planning/coverage.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::array<std::string_view, 4> kMembers = {"start", "spacing", "region", "body_radius"};

Result<Place> start_of(const boost::json::object& body, const mapping::Snapshot& maps) {
    if (const auto* start = body.if_contains("start")) return read_place(*start, "start", maps);
    if (maps.robots.size() == 1) {
        const auto pose = guide::pose_of(maps, 0);
        if (!pose) return prefixed("start is missing: ", pose.error());
        return Place{{pose->x, pose->y}, maps.robots[0].body_radius};
    }
    return Error{Errc::kInvalidField, fmt::format(R"(start is missing, and the session has {} robots; give [x, y] or )"
                                                  R"({{"robot": "name"}})",
                                                  maps.robots.size())};
}

Result<planning::CoverageOptions> options_of(const boost::json::object& body, const std::optional<double>& own) {
    planning::CoverageOptions options;
    const auto passability = passability_options(body, own);
    if (!passability) return passability.error();
    options.passability = *passability;
    const auto spacing = read_number(body, "spacing");
    if (!spacing) return spacing.error();
    options.spacing_m = *spacing;
    if (const auto* given = body.if_contains("region")) {
        auto region = read_region(*given, "region");
        if (!region) return region.error();
        options.region = std::move(*region);
    }
    return options;
}

std::string document_of(const mapping::Snapshot& maps, planning::Coverage&& coverage) {
    const double cell_size = maps.config.cell_size;
    const auto square_metres = [&](std::int64_t cells) {
        return rounded_metres(static_cast<double>(cells) * cell_size * cell_size);
    };
    const boost::json::object path{{"role", "path"},
                                   {"length", rounded_metres(coverage.path.length_m)},
                                   {"cost", rounded_metres(coverage.path.cost)},
                                   {"fraction", coverage.fraction},
                                   {"free_area", square_metres(coverage.free_cells)},
                                   {"covered_area", square_metres(coverage.covered_cells)},
                                   {"unreachable_area", rounded_metres(coverage.unreachable_m2)}};
    const boost::json::object unreachable{{"role", "unreachable"}, {"area", rounded_metres(coverage.unreachable_m2)}};
    const std::array features = {feature(path, line_string(coverage.path.points)),
                                 feature(unreachable, multi_polygon(std::move(coverage.unreachable), cell_size))};
    return collection_document(maps.revision, {}, features);
}

} // namespace

Result<Response> post_coverage(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    const auto found = find_for_search(maps, call, {});
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto body = parse_json_object(call.request.body);
    if (!body) return body.error();
    if (auto known = check_members(*body, kMembers); !known) return known.error();
    const auto start = start_of(*body, snapshot);
    if (!start) return start.error();
    const auto options = options_of(*body, start->body_radius);
    if (!options) return options.error();

    auto coverage = planning::plan_coverage(snapshot.classes, snapshot.config.cell_size, start->point, *options,
                                            guide::Patience(maps.sessions()));
    if (!coverage) return coverage.error();
    auto slot =
        slots.take(coverage->path.points.size() * kPointTextBytes + coverage->unreachable.size() * kCellTextBytes);
    if (!slot) return slot.error();
    return ok_text(kGeoJson, std::move(*slot), document_of(snapshot, std::move(*coverage)));
}

} // namespace scanloom::http
