#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scanloom::robot {

/// Which seq the server knows the scans of a spool by. It outlives the program: what was sent once under a seq is sent
/// again under the same.
struct Numbering {
    std::string session_id;    ///< of Welcome
    std::uint64_t first = 0;   ///< number within the spool of the first scan that may not be acknowledged
    std::uint64_t seq = 0;     ///< the seq of that scan; those behind it follow one by one
    std::uint64_t entered = 0; ///< scans of files that begin behind this number have never been sent

    friend bool operator==(const Numbering&, const Numbering&) = default;
};

/// Nothing where there is no such file: no server has been reached yet.
/// Errors  kMalformed: the file is damaged; kStoreFailed: it cannot be read.
[[nodiscard]] Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file);

/// Overwrites the file, all at once. Pre: the session id is a name. Errors  kStoreFailed.
[[nodiscard]] Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering);

} // namespace scanloom::robot
