#pragma once

#include "robot_client/recordings/recording.hpp"

#include <memory>

namespace scanloom::robot {

/// Returns whether a file begins as an SQLite database.
[[nodiscard]] bool is_sqlite(std::string_view first_bytes);

/// Opens a database of rosbag2 (.db3) read-only, without its metadata.yaml. Messages come in the order of their ids, in
/// which they were recorded. Columns that older versions of rosbag2 lack are not needed. Messages that rosbag2
/// compressed one by one are decompressed.
///
/// Files that SQLite keeps next to the database (-wal, -shm) are made only if a -wal file is there, whose messages are
/// not yet in the database.
/// Errors: kNotFound if it cannot be opened; kMalformed if it is no database of rosbag2.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_rosbag2(const std::filesystem::path& path);

} // namespace scanloom::robot
