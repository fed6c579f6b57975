#pragma once

#include "common/error/error.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A spool file: scans with consecutive numbers.
struct SpoolFile {
    std::uint64_t first = 0; ///< number of its first scan
    std::uint64_t scans = 0; ///< readable scans
    std::uint64_t bytes = 0;
    std::uint64_t from = 0;   ///< number of the first scan that is not known to be stored
    std::uint64_t seq = 0;    ///< seq of that scan, the following scans continue it; 0: none of them was sent
    bool is_headless = false; ///< its head is damaged: from and seq are unknown

    [[nodiscard]] std::uint64_t end() const noexcept { return first + scans; }         ///< number after its last scan
    [[nodiscard]] std::uint64_t left() const noexcept { return end() - from; }         ///< scans not known to be stored
    [[nodiscard]] std::uint64_t last_seq() const noexcept { return seq + left() - 1; } ///< Pre: it was sent

    /// Marks all scans up to this seq as stored by the server.
    void stored(std::uint64_t upto) noexcept {
        if (seq == 0 || upto < seq) return;
        const std::uint64_t count = std::min(upto + 1 - seq, left());
        from += count;
        seq += count;
    }
};

/// Returns the name of the file whose first scan has this number. Names sort like numbers.
[[nodiscard]] std::string segment_file(std::uint64_t first);

/// Returns the files of an earlier run in a directory, sorted by number. Empty files are removed. Files that cannot be
/// read or do not belong there are renamed and left out. `report` receives a message about both and about damage; the
/// scans before damage count.
/// Errors: kStoreFailed.
[[nodiscard]] Result<std::vector<SpoolFile>> segments_left(const std::filesystem::path& directory,
                                                           const std::function<void(const std::string&)>& report);

} // namespace scanloom::robot
