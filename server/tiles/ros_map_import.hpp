#pragma once

#include "common/error/error.hpp"
#include "common/scan/map_patch.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::tiles {

inline constexpr std::size_t kRosYamlBytesMax = 64 * 1024;

/// What the YAML file of a ROS map says of its image.
struct RosMapDescription {
    double resolution = 0.05; ///< metres a cell
    double origin_x = 0.0;    ///< metres: the lower-left corner of the image, in the map frame
    double origin_y = 0.0;
    bool negate = false; ///< white is occupied
    bool is_trinary = true;
    double occupied_thresh = 0.65; ///< probability above which a cell is occupied
    double free_thresh = 0.196;    ///< and below which it is free

    friend bool operator==(const RosMapDescription&, const RosMapDescription&) = default;
};

/// Reads the YAML of map_saver. Its `image` is not looked at: the image comes beside it.
/// Errors  kTooLarge: of more than kRosYamlBytesMax; kMalformed: no YAML, or no mapping of keys; kInvalidField, naming
///         the key: missing, given twice, or of a value that a map cannot have. A turned origin (yaw other than 0) and
///         the mode raw are refused.
/// Source  the formats of map_server (ROS 1) and nav2_map_server.
[[nodiscard]] Result<RosMapDescription> parse_ros_yaml(std::string_view yaml);

/// Reads an image, PGM or PNG of at most kMapPixelsMax pixels, into patches of a map, from its bottom row on.
/// A grey v stands for p = (255 - v) / 255 of occupation, or v / 255 where negated: above occupied_thresh it is
/// occupied, below free_thresh free. In a trinary map 205 is unknown whatever free_thresh says: map_saver writes it for
/// nothing else, and some of its files have a free_thresh above it.
/// Errors  kMalformed: no such image, or a damaged one; kInvalidField: a PGM whose white is not 255; kTooLarge.
[[nodiscard]] Result<std::vector<MapPatch>> read_ros_image(const RosMapDescription& description,
                                                           std::span<const std::uint8_t> image);

} // namespace scanloom::tiles
