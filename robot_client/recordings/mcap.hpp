#pragma once

#include "robot_client/recordings/recorded_bytes.hpp"
#include "robot_client/recordings/recording.hpp"

#include <memory>

namespace scanloom::robot {

/// Returns whether a file begins as an MCAP file, of any version.
[[nodiscard]] bool is_mcap(std::string_view first_bytes);

/// Opens an MCAP file of version 0. Chunks may be uncompressed, or compressed with lz4 or zstd.
///
/// The summary is not needed: it is read only if a message belongs to none of the channels seen so far. A chunk whose
/// checksum is wrong is a loss as a whole. Messages that rosbag2 compressed one by one are decompressed.
/// @param file  the file
/// @param name  the file's name, for messages
/// Errors: kUnsupportedVersion if it has another version; kMalformed if it is no MCAP file, or reading fails.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_mcap(std::unique_ptr<RecordedBytes> file, std::string name);

} // namespace scanloom::robot
