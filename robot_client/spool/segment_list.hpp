#pragma once

#include "common/error/error.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A file of the spool: scans whose numbers follow one another.
struct SpoolFile {
    std::uint64_t first = 0; ///< number of its first scan
    std::uint64_t scans = 0; ///< that can be read
    std::uint64_t bytes = 0;
    std::uint64_t from = 0;   ///< number of the first scan that is not known to be stored
    std::uint64_t seq = 0;    ///< of that scan, those behind it follow; 0: none of them was ever sent
    bool is_headless = false; ///< its head is damaged: from and seq are not known

    [[nodiscard]] std::uint64_t end() const noexcept { return first + scans; }         ///< number behind its last scan
    [[nodiscard]] std::uint64_t left() const noexcept { return end() - from; }         ///< scans not known to be stored
    [[nodiscard]] std::uint64_t last_seq() const noexcept { return seq + left() - 1; } ///< Pre: it was sent

    /// The server holds all scans up to this seq.
    void stored(std::uint64_t upto) noexcept {
        if (seq == 0 || upto < seq) return;
        const std::uint64_t count = std::min(upto + 1 - seq, left());
        from += count;
        seq += count;
    }
};

/// The name of the file whose first scan has this number. Names sort as numbers do.
[[nodiscard]] std::string segment_file(std::uint64_t first);

/// What an earlier run has left in a directory, by number. A file that holds nothing goes; one that cannot be read, or
/// is not where it belongs, gets another name and is left out. `tell` hears of both, and of damage: what stands before
/// it counts.
/// Errors  kStoreFailed.
[[nodiscard]] Result<std::vector<SpoolFile>> segments_left(const std::filesystem::path& directory,
                                                           const std::function<void(const std::string&)>& tell);

} // namespace scanloom::robot
