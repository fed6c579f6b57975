#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace rocksdb {
class Env;
}

/// Reads files from a disk on which parts of them are unreadable.
namespace scanloom::store {

struct ReadableBytes {
    std::string bytes;            ///< as many as the file has; zeros replace unreadable ones
    std::uint64_t unreadable = 0; ///< number of unreadable bytes, in pieces of 4 KiB
};

/// Reads what is readable of a file.
/// Errors: kStoreFailed: the file cannot be opened, or its size is unknown. Such a file is not treated as empty,
///         because its contents would be lost silently.
[[nodiscard]] Result<ReadableBytes> read_readable(const std::filesystem::path& file, rocksdb::Env& env);

/// Copies what is readable of a file.
/// @param to  must not exist
/// @return number of unreadable bytes, which are zeros in the copy
/// Errors: kStoreFailed: the file cannot be opened, its size is unknown, or the copy cannot be written.
[[nodiscard]] Result<std::uint64_t> copy_readable(const std::filesystem::path& file, const std::filesystem::path& to,
                                                  rocksdb::Env& env);

} // namespace scanloom::store
