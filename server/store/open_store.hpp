#pragma once

#include "server/store/rocksdb_store.hpp"
#include "server/store/unfinished_store.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

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

/// A store that is being written, by a copy. It cannot be opened otherwise until it is finished.
class NewStore {
public:
    /// Begins an empty store.
    /// Errors: kConflict: there is a store, or other files; otherwise as open_store().
    [[nodiscard]] static Result<NewStore> begin(const std::filesystem::path& store, const StoreOptions& options);

    [[nodiscard]] ScanLog& log() { return *log_; }

    /// Closes the log and makes it a store.
    /// Errors: kStoreFailed: it stays unfinished.
    [[nodiscard]] Result<> finish();

private:
    explicit NewStore(std::filesystem::path store) : store_(std::move(store)) {}

    std::filesystem::path store_;
    std::optional<UnfinishedStore> directory_; // nullopt: it is in a database
    std::unique_ptr<ScanLog> log_;
};

/// Opens a store for reading, and changes nothing of it.
/// Errors: those of open_read_only() for a directory, of open_postgres_read_only() for a database.
[[nodiscard]] Result<ReadOnlyStore> open_store_read_only(const std::filesystem::path& store);

} // namespace scanloom::store
