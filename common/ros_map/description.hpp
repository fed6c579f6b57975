#pragma once

#include "common/error/error.hpp"
#include "common/scan/map_patch.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Maps as the file pair of ROS map_server: an image and a YAML file that describes it.
/// Source  the formats of map_server (ROS 1) and nav2_map_server.
namespace scanloom {

inline constexpr std::size_t kRosYamlBytesMax = 64 * 1024;

/// How greys stand for occupation.
enum class RosMapMode {
    kTrinary, ///< free, occupied, or neither
    kScale,   ///< what is neither is in between, as its grey says
    kRaw,     ///< greys are per cents of occupation; above 100: unknown
};

/// What the YAML file of a ROS map says of its image.
struct RosMapDescription {
    std::string image;        ///< its file, relative to the YAML's folder; empty: not named
    double resolution = 0.05; ///< metres a cell
    double origin_x = 0.0;    ///< metres: the lower-left corner of the image, in the map frame
    double origin_y = 0.0;
    bool negate = false; ///< white is occupied
    RosMapMode mode = RosMapMode::kTrinary;
    double occupied_thresh = 0.65; ///< probability above which a cell is occupied
    double free_thresh = 0.196;    ///< and below which it is free

    friend bool operator==(const RosMapDescription&, const RosMapDescription&) = default;
};

/// Reads the YAML of map_saver.
/// Errors  kTooLarge: of more than kRosYamlBytesMax; kMalformed: no YAML, or no mapping of keys; kInvalidField, naming
///         the key: missing, given twice, or of a value that a map cannot have. A turned origin (yaw other than 0) is
///         refused, and negate with the mode raw: programs disagree on what it means.
[[nodiscard]] Result<RosMapDescription> parse_ros_yaml(std::string_view yaml);

/// The YAML of a trinary map of the greys below, for programs of ROS.
[[nodiscard]] std::string ros_yaml(std::string_view image, double resolution, double origin_x, double origin_y);

/// The greys of map_saver.
inline constexpr std::uint8_t kRosGreyFree = 254;
inline constexpr std::uint8_t kRosGreyOccupied = 0;
inline constexpr std::uint8_t kRosGreyUnknown = 205;

/// What each grey from 0 to `white` means.
/// A grey v stands for p = (white - v) / white of occupation, or v / white where negated: above occupied_thresh it is
/// occupied, below free_thresh free. In a trinary map 205 of 255 is unknown whatever free_thresh says: map_saver writes
/// it for nothing else, and some of its files have a free_thresh above it. Raw: p = v / 100, of greys from 0 to 255.
[[nodiscard]] std::vector<MapCell> cells_of_greys(const RosMapDescription& map, std::uint16_t white);

} // namespace scanloom
