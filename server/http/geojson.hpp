#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "core/grid/cell.hpp"
#include "server/http/response_limit.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// GeoJSON as text, in metres of the map frame. RFC 7946 knows only degrees; foreign members state the difference. The
/// text is written directly, because JSON values of many points would need many times its memory.
namespace scanloom::http {

/// Approximate bytes of text for one point of a line, and at most for one cell of an area.
inline constexpr std::size_t kPointTextBytes = 32;
inline constexpr std::size_t kCellTextBytes = 120;

/// [x, y]
[[nodiscard]] boost::json::array position(const Point2& point);

/// A Point.
[[nodiscard]] std::string point_geometry(const Point2& point);

/// A LineString. A single point is repeated, as a LineString needs two.
[[nodiscard]] std::string line_string(std::span<const Point2> points);

/// A MultiPolygon: the outlines of cells.
[[nodiscard]] std::string multi_polygon(std::vector<grid::Cell> cells, double cell_size_m);

/// A Feature for a collection.
[[nodiscard]] std::string feature(const boost::json::object& properties, std::string_view geometry,
                                  std::optional<std::uint64_t> id = std::nullopt);

/// A complete document: one Feature or a FeatureCollection.
/// @param members  further members of the collection
[[nodiscard]] std::string feature_document(Revision revision, const boost::json::object& properties,
                                           std::string_view geometry);
[[nodiscard]] std::string collection_document(Revision revision, const boost::json::object& members,
                                              std::span<const std::string> features);

/// Returns 200 with a text that may be large. The response keeps `permit` until it has been sent.
[[nodiscard]] Response ok_text(std::string_view content_type, limits::Semaphore::Permit permit, std::string text);

/// Returns ok_text() of a text that is made only if there is a permit for it.
/// @param permit  the result of ResponseLimit::take()
/// @param make    returns the text
/// Errors: that of `permit`.
template <std::invocable Make>
[[nodiscard]] Result<Response> ok_text(std::string_view content_type, Result<limits::Semaphore::Permit> permit,
                                       const Make& make) {
    if (!permit) return permit.error();
    return ok_text(content_type, std::move(*permit), make());
}

} // namespace scanloom::http
