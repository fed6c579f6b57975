#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store {

inline constexpr std::string_view kLockFile = "scanloom.lock";

/// There while a store is made for the first time, until it can be opened: what a kill leaves beside it is no store
/// that lost files.
inline constexpr std::string_view kNewFile = "scanloom.new";

/// There while a store is repaired into the directory, until all of it is there: see UnfinishedStore.
inline constexpr std::string_view kUnfinishedFile = "scanloom.unfinished";

/// What the names of a directory's files say about the store in it.
struct Listing {
    bool has_current = false;          ///< without it RocksDB sees no store
    bool has_tables = false;           ///< *.sst
    bool has_write_ahead_logs = false; ///< *.log
    bool is_new = false;               ///< kNewFile is there
    bool is_unfinished = false;        ///< kUnfinishedFile is there
    std::string trace;                 ///< a file that RocksDB makes beside these; empty: none
    std::string foreign;               ///< a file that no store has; empty: none
};

/// Errors  kStoreFailed: the directory cannot be listed.
[[nodiscard]] Result<Listing> listing_of(const std::filesystem::path& directory);

/// A directory's regular files, by name.
/// @param extension  with its dot; empty: all.
[[nodiscard]] std::vector<std::filesystem::path> regular_files(const std::filesystem::path& directory,
                                                               std::string_view extension = {});

/// Whether it is a file of a store, by its name: ours, or RocksDB's.
[[nodiscard]] bool is_store_file(const std::string& name);

/// RocksDB takes a directory without CURRENT for an empty one, and removes table files no manifest knows. So a store
/// that lost files is recognised before RocksDB sees it.
/// Errors  kStoreFailed: it lost files, or is unfinished; kNotFound: there are other files, and no store.
[[nodiscard]] Result<> check_listing(const std::filesystem::path& directory, const Listing& listing);

} // namespace scanloom::store
