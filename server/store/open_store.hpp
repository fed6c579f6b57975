#pragma once

#include "server/store/rocksdb_store.hpp"

#include <filesystem>
#include <memory>
#include <string>

/// Stores of each kind, by the value of --store: a directory, or the address of a database.
namespace scanloom::store {

/// Returns whether the store is in a database.
[[nodiscard]] bool is_in_database(const std::filesystem::path& store);

/// Checks the address of a database.
/// Errors: kInvalidField: it cannot be read, or names no database.
[[nodiscard]] Result<> check_address(const std::string& address);

/// Returns the value of --store for messages: without the password of an address.
[[nodiscard]] std::string shown(const std::filesystem::path& store);

/// Opens a store; creates it if it does not exist.
/// Errors: those of open_rocksdb() for a directory, of open_postgres() for a database.
[[nodiscard]] Result<std::unique_ptr<ScanLog>> open_store(const std::filesystem::path& store,
                                                          const StoreOptions& options = {});

/// Opens a store for reading, and changes nothing of it.
/// Errors: those of open_read_only() for a directory, of open_postgres_read_only() for a database.
[[nodiscard]] Result<ReadOnlyStore> open_store_read_only(const std::filesystem::path& store);

} // namespace scanloom::store
