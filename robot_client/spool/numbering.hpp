#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scanloom::robot {

/// How far a server has stored the scans of a spool. It is kept across restarts of the program.
struct Numbering {
    std::string session_id;         ///< of Welcome; empty: no server was reached yet
    std::uint64_t acknowledged = 0; ///< seq in that session: the server has all scans up to it
    std::optional<Poses> poses;     ///< what the poses of the scans are; nullopt: not known yet

    friend bool operator==(const Numbering&, const Numbering&) = default;
};

/// Reads the numbering, or returns nullopt if the file does not exist.
/// Errors: kMalformed if the file is damaged; kStoreFailed if it cannot be read.
[[nodiscard]] Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file);

enum class Sync : bool { kNo, kYes };

/// Overwrites the file atomically. Its size never changes, so only the first write needs room on the disk.
/// Pre: the session id is a name or empty.
/// Errors: kStoreFailed.
[[nodiscard]] Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering, Sync sync);

} // namespace scanloom::robot
