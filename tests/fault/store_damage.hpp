#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// Does something to the files of a store that a disk, or a person, may do: a bit is flipped, a sector reads as zeros,
/// a file ends early, is gone, or has changed places with another; at the border of two records of a log, or anywhere.
/// @return what was done, a sentence
[[nodiscard]] std::string damage(const std::filesystem::path& store, std::mt19937_64& random);

/// Where the records of a RocksDB log or manifest begin; see store::check_log_file().
[[nodiscard]] std::vector<std::size_t> record_borders(std::string_view bytes);

} // namespace scanloom::fault
