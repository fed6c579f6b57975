#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <filesystem>

namespace scanloom::store {

/// Reads a RocksDB table file and compares every block with its checksum, including blocks that no session needs any
/// more.
/// Errors: kDataLoss, naming the file.
[[nodiscard]] Result<> check_table(const std::filesystem::path& table, const StoreOptions& options = {});

} // namespace scanloom::store
