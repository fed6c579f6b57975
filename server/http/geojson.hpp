#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "server/grid/cell.hpp"
#include "server/http/response.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// GeoJSON as text, in metres of the map frame (RFC 7946 knows only degrees; the foreign members say so). Written
/// straight into the text: many points would be many times their size as JSON values.
namespace scanloom::http {

/// About how much text a point of a line takes, and a cell of an area at most: bytes.
inline constexpr std::size_t kPointTextBytes = 32;
inline constexpr std::size_t kCellTextBytes = 120;

/// [x, y]
[[nodiscard]] boost::json::array position(const Point2& point);

/// A Point.
[[nodiscard]] std::string point_geometry(const Point2& point);

/// A LineString; of a single point, one that stays there.
[[nodiscard]] std::string line_string(std::span<const Point2> points);

/// A MultiPolygon: the outlines of cells.
[[nodiscard]] std::string multi_polygon(std::vector<grid::Cell> cells, double cell_size_m);

/// A Feature, as one of a collection.
[[nodiscard]] std::string feature(const boost::json::object& properties, std::string_view geometry,
                                  std::optional<std::uint64_t> id = std::nullopt);

/// A whole document: one Feature, or a FeatureCollection of them.
/// @param members  more that it says of itself
[[nodiscard]] std::string feature_document(Revision revision, const boost::json::object& properties,
                                           std::string_view geometry);
[[nodiscard]] std::string collection_document(Revision revision, const boost::json::object& members,
                                              std::span<const std::string> features);

/// 200 with a text that may be large: its slot is kept until it was sent.
[[nodiscard]] Response ok_text(std::string_view content_type, std::shared_ptr<const void> slot, std::string text);

} // namespace scanloom::http
