#include "common/ros_map/description.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace scanloom {
namespace {

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

/// Reads a number; leaves `value` unchanged if the key is absent.
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
        map.negate = value == "1";
        const bool is_number = value == "0" || value == "1";
        // nav2 also accepts YAML's words for booleans: true, no, Off and so on.
        if (!is_number && !YAML::convert<bool>::decode(negate, map.negate)) {
            return bad_key("negate", "is neither 0 nor 1, true nor false");
        }
    }
    const auto mode = yaml["mode"];
    if (!mode) return {};
    const auto name = mode.IsScalar() ? mode.Scalar() : "";
    if (name != "trinary" && name != "scale" && name != "raw") {
        return bad_key("mode", "is neither trinary nor scale nor raw");
    }
    map.mode = name == "trinary" ? RosMapMode::kTrinary : name == "scale" ? RosMapMode::kScale : RosMapMode::kRaw;
    if (map.mode == RosMapMode::kRaw && map.negate) {
        return bad_key("negate", "is set in a raw map, where programs disagree on what it means; save it without");
    }
    return {};
}

Result<> read_image(const YAML::Node& yaml, RosMapDescription& map) {
    const auto image = yaml["image"];
    if (!image) return {};
    if (!image.IsScalar()) return bad_key("image", "is not the name of a file");
    map.image = image.Scalar();
    return {};
}

/// YAML forbids duplicate keys; yaml-cpp accepts them.
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

Result<RosMapDescription> read(const YAML::Node& yaml) {
    if (!yaml.IsMap()) return Error{Errc::kMalformed, "the map's yaml is not a list of keys with values"};
    RosMapDescription map;
    if (auto unique = check_unique(yaml); !unique) return unique.error();
    if (!yaml["resolution"]) return bad_key("resolution", "is missing; metres a cell are needed");
    if (auto done = read_number(yaml, "resolution", map.resolution); !done) return done.error();
    if (auto done = read_number(yaml, "occupied_thresh", map.occupied_thresh); !done) return done.error();
    if (auto done = read_number(yaml, "free_thresh", map.free_thresh); !done) return done.error();
    if (auto done = read_origin(yaml, map); !done) return done.error();
    if (auto done = read_mode(yaml, map); !done) return done.error();
    if (auto done = read_image(yaml, map); !done) return done.error();
    if (auto ok = check(map); !ok) return ok.error();
    return map;
}

/// Returns the text as a YAML scalar, quoted if it needs quotes.
std::string scalar(std::string_view text) {
    const bool is_plain = std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
    });
    if (is_plain && !text.empty()) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c;
    }
    return quoted + '"';
}

} // namespace

Result<RosMapDescription> parse_ros_yaml(std::string_view text) {
    if (text.size() > kRosYamlBytesMax) {
        return Error{Errc::kTooLarge, fmt::format("the map's yaml has {} bytes, more than {}; it needs the keys of "
                                                  "map_saver only",
                                                  text.size(), kRosYamlBytesMax)};
    }
    try {
        return read(YAML::Load(std::string(text)));
    } catch (const YAML::Exception& reason) {
        return Error{Errc::kMalformed, fmt::format("the map's yaml cannot be read: {}", reason.what())};
    }
}

std::string ros_yaml(std::string_view image, double resolution, double origin_x, double origin_y) {
    // 15 digits hide the rounding error of cell * cell_size: -5.05, not -5.050000000000001.
    // Programs that load the map compute p = 50 / 255 = 0.19608 for unknown cells: just above free_thresh.
    return fmt::format("image: {}\n"
                       "mode: trinary\n"
                       "resolution: {:.15g}\n"
                       "origin: [{:.15g}, {:.15g}, 0]\n"
                       "negate: 0\n"
                       "occupied_thresh: 0.65\n"
                       "free_thresh: 0.196\n",
                       scalar(image), resolution, origin_x, origin_y);
}

std::vector<MapCell> cells_of_greys(const RosMapDescription& map, std::uint16_t white) {
    std::vector<MapCell> cells(std::size_t{white} + 1, MapCell::kUnknown);
    for (std::size_t grey = 0; grey < cells.size(); ++grey) {
        const double value = static_cast<double>(grey) / white;
        const double byte = std::round(255.0 * value);
        if (map.mode == RosMapMode::kTrinary && byte == kRosGreyUnknown) continue;
        if (map.mode == RosMapMode::kRaw && byte > 100.0) continue;
        const double p = map.mode == RosMapMode::kRaw ? byte / 100.0 : map.negate ? value : 1.0 - value;
        if (p > map.occupied_thresh) cells[grey] = MapCell::kOccupied;
        if (p < map.free_thresh) cells[grey] = MapCell::kFree;
    }
    return cells;
}

} // namespace scanloom
