#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scanloom::robot {

/// How far a server has taken the scans of a spool. It outlives the program.
struct Numbering {
    std::string session_id;         ///< of Welcome; empty: none was reached yet
    std::uint64_t acknowledged = 0; ///< seq of that session: the server holds all scans up to it

    friend bool operator==(const Numbering&, const Numbering&) = default;
};

/// Nothing where there is no such file.
/// Errors  kMalformed: the file is damaged; kStoreFailed: it cannot be read.
[[nodiscard]] Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file);

enum class Sync : bool { kNo, kYes };

/// Overwrites the file, all at once. It is always of one size: only the first time it needs room on the disk.
/// Pre: the session id is a name, or empty. Errors  kStoreFailed.
[[nodiscard]] Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering, Sync sync);

} // namespace scanloom::robot
