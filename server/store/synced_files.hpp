#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string_view>

namespace scanloom::store {

/// Files and directories that survive a power cut once these return. Errors  kStoreFailed, with the system's reason.

/// What was made, renamed or removed in a directory is so for good. Without it a power cut could take it back.
[[nodiscard]] Result<> sync_directory(const std::filesystem::path& directory);

/// What was written to a file is there for good.
[[nodiscard]] Result<> sync_file(const std::filesystem::path& file);

/// Makes the store's directory, and those above it, unless it is there.
[[nodiscard]] Result<> create_store_directory(const std::filesystem::path& directory);

/// A small file that says something by being there, and a sentence to whoever reads it.
[[nodiscard]] Result<> write_mark(const std::filesystem::path& file, std::string_view sentence);
[[nodiscard]] Result<> remove_mark(const std::filesystem::path& file);

} // namespace scanloom::store
