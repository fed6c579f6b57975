#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Maps in the format of ROS map_server: an image and a YAML file that describes it.
/// Source: the formats of map_server (ROS 1) and nav2_map_server.
namespace scanloom {

inline constexpr std::size_t kRosYamlBytesMax = 64 * 1024;

/// How grey values encode occupancy.
enum class RosMapMode {
    kTrinary, ///< free, occupied or unknown
    kScale,   ///< greys between free and occupied encode the probability
    kRaw,     ///< greys are the occupancy in per cent; above 100: unknown
};

/// The contents of the YAML file of a ROS map.
struct RosMapDescription {
    std::string image;        ///< image file, relative to the YAML's folder; empty: not given
    double resolution = 0.05; ///< metres per cell
    double origin_x = 0.0;    ///< metres: the lower-left corner of the image, in the map frame
    double origin_y = 0.0;
    bool negate = false; ///< whether white is occupied
    RosMapMode mode = RosMapMode::kTrinary;
    double occupied_thresh = 0.65; ///< a cell is occupied above this probability
    double free_thresh = 0.196;    ///< a cell is free below this probability

    friend bool operator==(const RosMapDescription&, const RosMapDescription&) = default;
};

/// Parses the YAML file of a ROS map.
/// Errors: kTooLarge if it has more than kRosYamlBytesMax bytes; kMalformed if it is not YAML or not a mapping of keys
///         to values; kInvalidField, with the key's name, if a key is missing, is given twice or has an invalid value.
///         Rotated maps (yaw other than 0) are rejected, and `negate` in raw mode, as programs disagree on its meaning.
[[nodiscard]] Result<RosMapDescription> parse_ros_yaml(std::string_view yaml);

/// Writes the YAML file of a trinary map with the greys below, for ROS programs.
/// @param image       name of the image file
/// @param resolution  metres per cell
/// @param origin_x    metres: lower-left corner of the image, in the map frame
/// @param origin_y    metres
/// @return the contents of the file
[[nodiscard]] std::string ros_yaml(std::string_view image, double resolution, double origin_x, double origin_y);

/// The greys that map_saver writes.
inline constexpr std::uint8_t kRosGreyFree = 254;
inline constexpr std::uint8_t kRosGreyOccupied = 0;
inline constexpr std::uint8_t kRosGreyUnknown = 205;

/// Returns the state of a cell for each grey from 0 to `white`, the image's highest grey.
///
/// The probability of occupancy of a grey v is p = (white - v) / white, or v / white if negated. In raw mode it is
/// p = v / 100, with v scaled to 0..255. The cell is occupied if p is above occupied_thresh and free if p is below
/// free_thresh. In a trinary map, 205 of 255 is unknown regardless of free_thresh: map_saver uses it for unknown cells
/// only, and some of its files have a free_thresh above its probability.
[[nodiscard]] std::vector<MapCell> cells_of_greys(const RosMapDescription& map, std::uint16_t white);

} // namespace scanloom
