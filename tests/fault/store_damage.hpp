#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// Damages the files of a store in a way that a disk or a person may: flips a bit, zeroes a sector, truncates a file,
/// removes it, or exchanges it with another; at the border of two records of a log, or anywhere. @return a sentence
/// that describes the damage
[[nodiscard]] std::string damage(const std::filesystem::path& store, std::mt19937_64& random);

/// Returns where the records of a RocksDB log or manifest begin; see store::check_log_file().
[[nodiscard]] std::vector<std::size_t> record_borders(std::string_view bytes);

} // namespace scanloom::fault
