#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string_view>

namespace scanloom::store {

/// Changes of files and directories that survive a power loss once the call has returned.
/// Errors: kStoreFailed, with the system's reason.

/// Makes creations, renames and removals in a directory durable. Without it, a power loss may undo them.
[[nodiscard]] Result<> sync_directory(const std::filesystem::path& directory);

/// Makes the contents of a file durable.
[[nodiscard]] Result<> sync_file(const std::filesystem::path& file);

/// Creates the store's directory and its parents as needed.
[[nodiscard]] Result<> create_store_directory(const std::filesystem::path& directory);

/// Writes a small file that marks a state by its existence; the sentence in it explains it to a reader.
[[nodiscard]] Result<> write_mark(const std::filesystem::path& file, std::string_view sentence);
[[nodiscard]] Result<> remove_mark(const std::filesystem::path& file);

} // namespace scanloom::store
