#include "server/http/handlers/parameters.hpp"

#include "server/guidance/robots.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace scanloom::http {
namespace {

std::optional<tiles::Extent> parse_extent(std::string_view text) {
    std::array<double, 4> edges{};
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto comma = text.find(',');
        if ((comma == std::string_view::npos) != (i + 1 == edges.size())) return std::nullopt;
        const auto edge = parse_real(text.substr(0, comma));
        if (!edge) return std::nullopt;
        edges[i] = *edge;
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return tiles::Extent{edges[0], edges[1], edges[2], edges[3]};
}

} // namespace

Result<mapping::Layer> find_layer(std::string_view name) {
    if (const auto layer = mapping::layer_of(name)) return *layer;
    std::array<std::string_view, mapping::kLayers.size()> names;
    std::ranges::transform(mapping::kLayers, names.begin(), mapping::name_of);
    return Error{Errc::kNotFound,
                 fmt::format("there is no layer {}; possible are {}", in_quotes(name), fmt::join(names, ", "))};
}

Result<mapping::Layer> layer_parameter(const Query& query) {
    return find_layer(query.find("layer").value_or(mapping::name_of(mapping::Layer::kOccupancy)));
}

Result<Revision> since_parameter(const Query& query) {
    return parameter(query, "since", Revision{0}, parse_integer<Revision>,
                     "a revision is needed, a whole number from 0 to 18446744073709551615");
}

Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept {
    return since >= snapshot.exclusions->revision() && since <= snapshot.revision ? since : 0;
}

Revision since_in_poses(const mapping::Snapshot& snapshot, Revision since) noexcept {
    return since >= snapshot.scan_poses.corrected() ? since_in(snapshot, since) : 0;
}

Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query) {
    return parameter(query, "bbox", std::optional<tiles::Extent>(), parse_extent,
                     "min_x,min_y,max_x,max_y in metres is needed");
}

Result<RobotIndex> robot_named(const mapping::Snapshot& maps, std::string_view name) {
    const auto robot = guidance::find_robot(maps, name);
    if (!robot) return prefixed(fmt::format("robot is {}: ", in_quotes(name)), robot.error());
    return *robot;
}

} // namespace scanloom::http
