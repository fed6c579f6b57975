#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace rocksdb {
class Env;
}

/// The store in a directory of RocksDB files.
namespace scanloom::store {

struct StoreOptions {
    /// Bound of write buffers and block cache together. The default suits both 1 GB and 24 GB of memory: the log is
    /// read in order, so a larger cache would hardly be used, and the system caches files.
    std::size_t memory_bytes = std::size_t{128} << 20;

    /// Disk space that is left free. With less, changes that add data are refused with kOverloaded and nothing of them
    /// is stored, so that sessions can still be removed and tables merged.
    std::uint64_t disk_reserve_bytes = std::uint64_t{256} << 20;

    /// Called once, from a thread of the store, when a file is found to be damaged at run time. New entries are stored
    /// as before; reading the damaged data returns an error.
    std::function<void(const Error&)> on_damage;

    /// Called on the reader's thread for every log that ScanLog::read() could not read to its end, with kDataLoss or
    /// kStoreFailed.
    std::function<void(SessionId, const Error&)> on_unreadable;

    /// Called with each line of level WARN and above that the database logs, from one of its threads. Null: the lines
    /// are dropped.
    std::function<void(std::string_view)> on_log_line;

    /// For a store in a database: accept one that has no synchronous standby, so that the loss of its machine loses
    /// acknowledged scans.
    bool allow_unreplicated = false;

    /// For a store in a database: see PostgresOptions::bytes_max.
    std::optional<std::uint64_t> bytes_max;

    /// For a store in a database: see PostgresOptions::node.
    std::string node;

    /// The file layer; tests replace it to inject failures. Null: the system's.
    rocksdb::Env* env = nullptr;
};

/// Opens the store in a directory; creates both if they do not exist.
///
/// Errors: kConflict: another process uses it; kNotFound: the directory holds other files and no store; kStoreFailed,
///         kDataLoss: the directory cannot be used, or the store in it is damaged; the message names the file;
///         kUnsupportedVersion: a newer program wrote it. A write that a crash cut short is not damage: it was never
///         acknowledged and is dropped.
[[nodiscard]] Result<std::unique_ptr<ScanLog>> open_rocksdb(const std::filesystem::path& directory,
                                                            const StoreOptions& options = {});

/// Opens a store; open_store() or a replacement for it.
using OpenStore = std::function<Result<std::unique_ptr<ScanLog>>(const std::filesystem::path&, const StoreOptions&)>;

/// Opens a store for reading and changes no byte of it: neither a lock file nor a log line is left behind. Reads
/// manifest and write-ahead log as a start does.
///
/// Errors: kNotFound: there is no store; kConflict: a server has it open; kStoreFailed, kDataLoss: it cannot be read,
///         or is so damaged that a start would refuse it as well; kUnsupportedVersion: a newer program wrote it.
[[nodiscard]] Result<ReadOnlyStore> open_read_only(const std::filesystem::path& directory,
                                                   const StoreOptions& options = {});

/// Reads a table file and compares every block with its checksum, including blocks that no session needs any more.
/// Errors: kDataLoss, naming the file.
[[nodiscard]] Result<> check_table(const std::filesystem::path& table, const StoreOptions& options = {});

} // namespace scanloom::store
