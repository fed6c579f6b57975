#include "server/tiles/ros_map_import.hpp"

#include "common/ros_map/pgm.hpp"
#include "common/scan/limits.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <iterator>

namespace scanloom::tiles {
namespace {

constexpr std::array<std::uint8_t, 8> kPngMark = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kPngSizeAt = 16;

bool is_png(std::span<const std::uint8_t> image) {
    return image.size() > kPngSizeAt + 8 && std::equal(kPngMark.begin(), kPngMark.end(), image.begin());
}

/// Reads width and height, which precede anything that takes memory.
Result<> check_png_size(std::span<const std::uint8_t> image) {
    const auto big_endian = [&](std::size_t at) {
        std::int64_t value = 0;
        for (std::size_t n = 0; n < 4; ++n) value = value << 8 | image[at + n];
        return value;
    };
    return check_ros_image_size(big_endian(kPngSizeAt), big_endian(kPngSizeAt + 4));
}

Result<cv::Mat> decode_png(std::span<const std::uint8_t> image) {
    if (auto ok = check_png_size(image); !ok) return ok.error();
    try {
        const cv::Mat bytes(1, static_cast<int>(image.size()), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
        const cv::Mat grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
        if (!grey.empty()) return grey;
    } catch (const cv::Exception&) { // treated as an empty image
    }
    return Error{Errc::kMalformed, "the map's image is damaged: it cannot be decoded to its end"};
}

Result<MapCells> read_png(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    const auto grey = decode_png(image);
    if (!grey) return grey.error();
    const auto cell_of = cells_of_greys(map, 255);
    MapCells read{static_cast<std::size_t>(grey->cols), {}};
    read.cells.reserve(grey->total());
    for (int row = grey->rows; row-- > 0;) {
        const auto* pixels = grey->ptr<std::uint8_t>(row);
        std::transform(pixels, pixels + read.width, std::back_inserter(read.cells),
                       [&](std::uint8_t pixel) { return cell_of[pixel]; });
    }
    return read;
}

Result<MapCells> read_cells(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    if (is_png(image)) return read_png(map, image);
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
