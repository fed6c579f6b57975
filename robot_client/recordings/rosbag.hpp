#pragma once

#include "robot_client/recordings/recorded_bytes.hpp"
#include "robot_client/recordings/recording.hpp"

#include <memory>

namespace scanloom::robot {

/// Returns whether a file begins as a ROS 1 bag, of any version.
[[nodiscard]] bool is_rosbag(std::string_view first_bytes);

/// Opens a ROS 1 bag of format 2.0. Chunks may be uncompressed, or compressed with bz2 or lz4.
///
/// Neither the bag's index nor its chunk infos are needed. The connections that are repeated after the last chunk are
/// read only if a message belongs to none of those seen so far.
/// @param file  the bag
/// @param name  the file's name, for messages
/// Errors: kUnsupportedVersion if it has another version or is encrypted; kMalformed if it is no bag, or reading fails.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_rosbag(std::unique_ptr<RecordedBytes> file, std::string name);

} // namespace scanloom::robot
