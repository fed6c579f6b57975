#include "server/tiles/ros_map_import.hpp"

#include "common/scan/limits.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace scanloom::tiles {
namespace {

constexpr std::uint8_t kTrinaryUnknown = 205;
constexpr std::size_t kKeyShown = 40; // characters

Error bad_key(std::string_view key, std::string_view what) {
    return {Errc::kInvalidField, fmt::format("the map's yaml: {} {}", key, what)};
}

Result<double> number(const YAML::Node& node, std::string_view key) {
    double value = 0.0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
        return bad_key(key, "is not a number");
    }
    return value;
}

/// Leaves the value where the key is absent.
Result<> read_number(const YAML::Node& yaml, const char* key, double& value) {
    const auto node = yaml[key];
    if (!node) return {};
    const auto read = number(node, key);
    if (!read) return read.error();
    value = *read;
    return {};
}

Result<> read_origin(const YAML::Node& yaml, RosMapDescription& map) {
    const auto origin = yaml["origin"];
    if (!origin || !origin.IsSequence() || origin.size() < 2 || origin.size() > 3) {
        return bad_key("origin", "is not a list [x, y, yaw] in metres and radians");
    }
    std::array<double, 3> values{};
    for (std::size_t n = 0; n < origin.size(); ++n) {
        const auto read = number(origin[n], "origin");
        if (!read) return read.error();
        values[n] = *read;
    }
    if (values[2] != 0.0) return bad_key("origin", "is turned; only maps with a yaw of 0 can be imported");
    if (std::max(std::abs(values[0]), std::abs(values[1])) > kCoordinateMax / 2.0) {
        return bad_key("origin", "is too far away");
    }
    map.origin_x = values[0];
    map.origin_y = values[1];
    return {};
}

Result<> read_mode(const YAML::Node& yaml, RosMapDescription& map) {
    if (const auto negate = yaml["negate"]) {
        const auto value = negate.IsScalar() ? negate.Scalar() : "";
        map.negate = value == "1" || value == "true"; // nav2 takes the words, too
        if (!map.negate && value != "0" && value != "false") return bad_key("negate", "is neither 0 nor 1");
    }
    const auto mode = yaml["mode"];
    if (!mode) return {};
    if (!mode.IsScalar() || (mode.Scalar() != "trinary" && mode.Scalar() != "scale")) {
        return bad_key("mode", "is neither trinary nor scale, the ones that can be imported");
    }
    map.is_trinary = mode.Scalar() == "trinary";
    return {};
}

/// YAML forbids a key given twice; yaml-cpp lets it pass.
Result<> check_unique(const YAML::Node& yaml) {
    std::set<std::string> keys;
    for (const auto& entry : yaml) {
        if (entry.first.IsScalar() && !keys.insert(entry.first.Scalar()).second) {
            return bad_key(entry.first.Scalar().substr(0, kKeyShown), "is given twice");
        }
    }
    return {};
}

Result<> check(const RosMapDescription& map) {
    if (!(map.resolution >= 1e-3 && map.resolution <= kMapCellSizeMax)) {
        return bad_key("resolution",
                       fmt::format("is {}; 0.001 to {} metres a cell are possible", map.resolution, kMapCellSizeMax));
    }
    const bool in_order = map.free_thresh >= 0.0 && map.free_thresh < map.occupied_thresh && map.occupied_thresh <= 1.0;
    if (!in_order) return bad_key("occupied_thresh", "and free_thresh are not probabilities with the free one below");
    return {};
}

/// A number of a PGM's header, after white space and comments; taken off the front.
std::optional<std::int64_t> take_number(std::span<const std::uint8_t>& rest) {
    while (!rest.empty() && (rest.front() == '#' || std::isspace(rest.front()) != 0)) {
        if (rest.front() != '#') {
            rest = rest.subspan(1);
            continue;
        }
        const auto end = std::ranges::find(rest, '\n');
        rest = rest.subspan(static_cast<std::size_t>(end - rest.begin()));
    }
    const auto* begin = reinterpret_cast<const char*>(rest.data());
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(begin, begin + std::min<std::size_t>(rest.size(), 32), value);
    if (error != std::errc{}) return std::nullopt;
    rest = rest.subspan(static_cast<std::size_t>(end - begin));
    return value;
}

struct ImageHead {
    std::int64_t width = 0;
    std::int64_t height = 0;
    std::int64_t white = 255; ///< the highest grey
};

/// Of a PGM or a PNG, before anything is made of it.
std::optional<ImageHead> head_of(std::span<const std::uint8_t> image) {
    constexpr std::array<std::uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    constexpr std::size_t kPngSizeAt = 16;
    if (image.size() > kPngSizeAt + 8 && std::equal(kPng.begin(), kPng.end(), image.begin())) {
        const auto big_endian = [&](std::size_t at) {
            std::int64_t value = 0;
            for (std::size_t n = 0; n < 4; ++n) value = value << 8 | image[at + n];
            return value;
        };
        return ImageHead{big_endian(kPngSizeAt), big_endian(kPngSizeAt + 4)};
    }
    if (image.size() < 3 || image[0] != 'P' || (image[1] != '2' && image[1] != '5')) return std::nullopt;
    auto rest = image.subspan(2);
    const auto width = take_number(rest);
    const auto height = width ? take_number(rest) : std::nullopt;
    const auto white = height ? take_number(rest) : std::nullopt;
    if (!white) return std::nullopt;
    return ImageHead{*width, *height, *white};
}

Result<cv::Mat> decode(std::span<const std::uint8_t> image) {
    const auto head = head_of(image);
    if (!head || head->width <= 0 || head->height <= 0) {
        return Error{Errc::kMalformed, "the map's image is neither a PGM (P2, P5) nor a PNG, or is damaged"};
    }
    if (head->width > kMapSideMax || head->height > kMapSideMax || head->width * head->height > kMapPixelsMax) {
        return Error{Errc::kTooLarge, fmt::format("the map's image has {} x {} pixels, more than {}", head->width,
                                                  head->height, kMapPixelsMax)};
    }
    if (head->white != 255) {
        return Error{Errc::kInvalidField, fmt::format("the map's image has a highest grey (maxval) of {}; save it with "
                                                      "255, as map_saver does",
                                                      head->white)};
    }
    try {
        const cv::Mat bytes(1, static_cast<int>(image.size()), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
        const cv::Mat grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
        if (!grey.empty()) return grey;
    } catch (const cv::Exception&) { // as if it were empty
    }
    return Error{Errc::kMalformed, "the map's image is damaged: it cannot be decoded to its end"};
}

std::array<MapCell, 256> cells_of_greys(const RosMapDescription& map) {
    std::array<MapCell, 256> cells{};
    for (std::size_t grey = 0; grey < cells.size(); ++grey) {
        const double value = static_cast<double>(grey) / 255.0;
        const double p = map.negate ? value : 1.0 - value;
        const bool is_unknown = map.is_trinary && grey == kTrinaryUnknown;
        if (!is_unknown && p > map.occupied_thresh) cells[grey] = MapCell::kOccupied;
        if (!is_unknown && p < map.free_thresh) cells[grey] = MapCell::kFree;
    }
    return cells;
}

} // namespace

Result<RosMapDescription> parse_ros_yaml(std::string_view text) {
    if (text.size() > kRosYamlBytesMax) {
        return Error{Errc::kTooLarge, fmt::format("the map's yaml has {} bytes, more than {}; it needs the keys of "
                                                  "map_saver only",
                                                  text.size(), kRosYamlBytesMax)};
    }
    try {
        const YAML::Node yaml = YAML::Load(std::string(text));
        if (!yaml.IsMap()) return Error{Errc::kMalformed, "the map's yaml is not a list of keys with values"};
        RosMapDescription map;
        if (auto unique = check_unique(yaml); !unique) return unique.error();
        if (!yaml["resolution"]) return bad_key("resolution", "is missing; metres a cell are needed");
        if (auto read = read_number(yaml, "resolution", map.resolution); !read) return read.error();
        if (auto read = read_number(yaml, "occupied_thresh", map.occupied_thresh); !read) return read.error();
        if (auto read = read_number(yaml, "free_thresh", map.free_thresh); !read) return read.error();
        if (auto read = read_origin(yaml, map); !read) return read.error();
        if (auto read = read_mode(yaml, map); !read) return read.error();
        if (auto ok = check(map); !ok) return ok.error();
        return map;
    } catch (const YAML::Exception& reason) {
        return Error{Errc::kMalformed, fmt::format("the map's yaml cannot be read: {}", reason.what())};
    }
}

Result<std::vector<MapPatch>> read_ros_image(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    const auto grey = decode(image);
    if (!grey) return grey.error();
    const auto width = static_cast<std::size_t>(grey->cols);
    const auto height = static_cast<std::size_t>(grey->rows);
    if (width > kMapPatchCellsMax) {
        return Error{Errc::kTooLarge, fmt::format("the map's image is {} pixels wide, at most {} are possible", width,
                                                  kMapPatchCellsMax)};
    }
    const double reach = static_cast<double>(std::max(width, height)) * map.resolution;
    if (reach > kCoordinateMax) return Error{Errc::kTooLarge, "the map is larger than the world can be"};
    const auto cells = cells_of_greys(map);
    const std::size_t rows_max = kMapPatchCellsMax / width;
    std::vector<MapPatch> patches;
    for (std::size_t row = 0; row < height; row += rows_max) { // rows counted from the bottom
        MapPatch patch{map.resolution,
                       map.origin_x,
                       map.origin_y + static_cast<double>(row) * map.resolution,
                       static_cast<std::uint32_t>(width),
                       {}};
        for (std::size_t j = row; j < std::min(height, row + rows_max); ++j) {
            const auto* pixels = grey->ptr<std::uint8_t>(static_cast<int>(height - 1 - j));
            std::transform(pixels, pixels + width, std::back_inserter(patch.cells),
                           [&](std::uint8_t pixel) { return cells[pixel]; });
        }
        patches.push_back(std::move(patch));
    }
    return patches;
}

} // namespace scanloom::tiles
