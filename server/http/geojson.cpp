#include "server/http/geojson.hpp"

#include "common/json/json_text.hpp"
#include "core/grid/outline.hpp"
#include "server/http/text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

namespace scanloom::http {
namespace {

void append_position(std::string& text, double x, double y) {
    fmt::format_to(std::back_inserter(text), "[{},{}]", rounded_metres(x), rounded_metres(y));
}

/// Appends [a,b,c], where write() appends each element.
template <class Items, class Write>
void append_list(std::string& text, const Items& items, Write&& write) {
    const char* separator = "[";
    for (const auto& item : items) {
        text += separator;
        write(item);
        separator = ",";
    }
    text += items.empty() ? "[]" : "]";
}

} // namespace

boost::json::array position(const Point2& point) { return {rounded_metres(point.x), rounded_metres(point.y)}; }

std::string point_geometry(const Point2& point) {
    std::string text = R"({"type":"Point","coordinates":)";
    append_position(text, point.x, point.y);
    return text += '}';
}

std::string line_string(std::span<const Point2> points) {
    std::vector<Point2> line(points.begin(), points.end());
    if (line.size() == 1) line.push_back(line.front());
    std::string text = R"({"type":"LineString","coordinates":)";
    append_list(text, line, [&](const Point2& point) { append_position(text, point.x, point.y); });
    return text += '}';
}

std::string multi_polygon(std::vector<grid::Cell> cells, double cell_size_m) {
    const auto append_corner = [cell_size_m](std::string& text, grid::Cell corner) {
        append_position(text, corner.i * cell_size_m, corner.j * cell_size_m);
    };
    std::string text = R"({"type":"MultiPolygon","coordinates":)";
    append_list(text, grid::outlines_of(std::move(cells)), [&](const grid::Outline& outline) {
        append_list(text, outline, [&](const grid::Ring& ring) {
            append_list(text, ring, [&](grid::Cell corner) { append_corner(text, corner); });
        });
    });
    return text += '}';
}

std::string feature(const boost::json::object& properties, std::string_view geometry, std::optional<std::uint64_t> id) {
    return fmt::format(R"({{"type":"Feature",{}"properties":{},"geometry":{}}})",
                       id ? fmt::format(R"("id":{},)", *id) : "", json_text(properties), geometry);
}

std::string feature_document(Revision revision, const boost::json::object& properties, std::string_view geometry) {
    return fmt::format(
        R"({{"type":"Feature","frame_id":"map","units":"m","revision":{},"properties":{},"geometry":{}}})", revision,
        json_text(properties), geometry);
}

std::string collection_document(Revision revision, const boost::json::object& members,
                                std::span<const std::string> features) {
    std::string text =
        fmt::format(R"({{"type":"FeatureCollection","frame_id":"map","units":"m","revision":{})", revision);
    for (const auto& [name, value] : members) {
        text += fmt::format(R"(,"{}":{})", std::string_view(name.data(), name.size()), json_text(value));
    }
    text += R"(,"features":)";
    append_list(text, features, [&](const std::string& one) { text += one; });
    return text += '}';
}

Response ok_text(std::string_view content_type, limits::Semaphore::Permit permit, std::string text) {
    return ok(content_type, with_permit(std::move(permit), std::move(text))).set("Cache-Control", kNotKept);
}

} // namespace scanloom::http
