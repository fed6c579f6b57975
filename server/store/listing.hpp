#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store {

inline constexpr std::string_view kLockFile = "scanloom.lock";

/// Exists while a store is created, until it can be opened. What a killed process leaves next to it is not taken for a
/// store that lost files.
inline constexpr std::string_view kNewFile = "scanloom.new";

/// Exists while a store is repaired into the directory, until the store is complete; see UnfinishedStore.
inline constexpr std::string_view kUnfinishedFile = "scanloom.unfinished";

/// What the file names in a directory show about the store in it.
struct Listing {
    bool has_current = false;          ///< without it, RocksDB sees no store
    bool has_tables = false;           ///< *.sst
    bool has_write_ahead_logs = false; ///< *.log
    bool is_new = false;               ///< kNewFile exists
    bool is_unfinished = false;        ///< kUnfinishedFile exists
    std::string trace;                 ///< name of another file that RocksDB creates; empty: none
    std::string foreign;               ///< name of a file that belongs to no store; empty: none
};

/// Lists a directory.
/// Errors: kStoreFailed: the directory cannot be listed.
[[nodiscard]] Result<Listing> listing_of(const std::filesystem::path& directory);

/// Returns a directory's regular files, sorted by name.
/// @param extension  with its dot; empty: all files
[[nodiscard]] std::vector<std::filesystem::path> regular_files(const std::filesystem::path& directory,
                                                               std::string_view extension = {});

/// Whether a file with this name belongs to a store, as a file of Scanloom or of RocksDB.
[[nodiscard]] bool is_store_file(const std::string& name);

/// Detects a store that lost files before RocksDB opens it: RocksDB takes a directory without CURRENT for an empty one
/// and removes table files that no manifest names.
/// Errors: kStoreFailed: the store lost files or is unfinished; kNotFound: there are other files, and no store.
[[nodiscard]] Result<> check_listing(const std::filesystem::path& directory, const Listing& listing);

} // namespace scanloom::store
