#include "server/tiles/ros_map_import.hpp"

#include "common/ros_map/pgm.hpp"
#include "common/scan/limits.hpp"
#include "server/tiles/png_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace scanloom::tiles {
namespace {

constexpr std::array<std::uint8_t, 8> kPngMark = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

bool is_png(std::span<const std::uint8_t> image) {
    return image.size() > kPngMark.size() && std::equal(kPngMark.begin(), kPngMark.end(), image.begin());
}

Result<MapCells> read_png_cells(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    const auto grey = read_png(image);
    if (!grey) return grey.error();
    const auto cell_of = cells_of_greys(map, 255);
    MapCells read{grey->width, {}};
    read.cells.reserve(grey->pixels.size());
    for (std::size_t row = grey->height; row-- > 0;) {
        const auto pixels = std::span(grey->pixels).subspan(row * read.width, read.width);
        std::ranges::transform(pixels, std::back_inserter(read.cells),
                               [&](std::uint8_t pixel) { return cell_of[pixel]; });
    }
    return read;
}

Result<MapCells> read_cells(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    if (is_png(image)) return read_png_cells(map, image);
    if (image.size() >= 2 && image[0] == 'P' && (image[1] == '2' || image[1] == '5')) return read_ros_pgm(map, image);
    return Error{Errc::kMalformed, "the map's image is neither a PGM (P2, P5) nor a PNG, or is damaged"};
}

} // namespace

Result<std::vector<MapPatch>> read_ros_image(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    const auto read = read_cells(map, image);
    if (!read) return read.error();
    const std::size_t width = read->width;
    if (width > kMapPatchCellsMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("the map's image is {} pixels wide, more than {}", width, kMapPatchCellsMax)};
    }
    const double reach = static_cast<double>(std::max(width, read->height())) * map.resolution;
    if (reach > kCoordinateMax) return Error{Errc::kTooLarge, "the map is larger than the range of coordinates"};
    const std::size_t rows_max = kMapPatchCellsMax / width;
    std::vector<MapPatch> patches;
    for (std::size_t row = 0; row < read->height(); row += rows_max) {
        const auto rows =
            std::span(read->cells).subspan(row * width).first(std::min(read->height() - row, rows_max) * width);
        patches.push_back({map.resolution,
                           map.origin_x,
                           map.origin_y + static_cast<double>(row) * map.resolution,
                           static_cast<std::uint32_t>(width),
                           {rows.begin(), rows.end()}});
    }
    return patches;
}

} // namespace scanloom::tiles
