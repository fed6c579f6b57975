#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace rocksdb {
class Env;
}

/// Files of a disk that cannot read all of them any more.
namespace scanloom::store {

struct ReadableBytes {
    std::string bytes;            ///< as many as the file has; zeros in place of those that cannot be read
    std::uint64_t unreadable = 0; ///< so many of them, in pieces of 4 KiB
};

/// Errors  kStoreFailed: the file cannot be opened, or its size not be told. One that cannot be opened is not one without
///         anything in it: what it has would be lost without a word.
[[nodiscard]] Result<ReadableBytes> read_readable(const std::filesystem::path& file, rocksdb::Env& env);

/// @param to  does not exist.
/// @return how many bytes cannot be read, and are zeros in the copy.
/// Errors  as above; kStoreFailed: the copy cannot be written.
[[nodiscard]] Result<std::uint64_t> copy_readable(const std::filesystem::path& file, const std::filesystem::path& to,
                                                  rocksdb::Env& env);

} // namespace scanloom::store
