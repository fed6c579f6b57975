#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A file of the spool: scans whose numbers follow one another.
struct SpoolFile {
    std::uint64_t first = 0; ///< number of its first scan
    std::uint64_t scans = 0;
    std::uint64_t bytes = 0;
    std::uint64_t first_seq = 0; ///< known once it is entered
};

/// The name of the file whose first scan has this number. Names sort as numbers do.
[[nodiscard]] std::string segment_file(std::uint64_t first);

/// What an earlier run has left in a directory, by number. A file without scans goes, and so does one with scans before
/// `first_unacknowledged` only. `tell` hears of damage: what stands before it counts.
/// Errors  kStoreFailed; kMalformed: a file that is not the spool's.
[[nodiscard]] Result<std::vector<SpoolFile>> segments_left(const std::filesystem::path& directory,
                                                           std::uint64_t first_unacknowledged,
                                                           const std::function<void(const std::string&)>& tell);

} // namespace scanloom::robot
