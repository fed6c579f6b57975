#pragma once

#include "server/store/compaction_switch.hpp"
#include "server/store/files_watch.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/db.h>
#include <rocksdb/write_batch.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace scanloom::store {

/// One change of the store.
struct Change {
    std::uint64_t bytes = 0;   ///< about what it adds to the write
    std::uint64_t appends = 0; ///< what to count when it is durable
    std::uint64_t entries = 0;
    bool frees_disk = false; ///< made also where the disk is as good as full

    /// Adds the change to the write, or refuses it and adds nothing. Called on the committer's thread, in order.
    std::function<Result<>(rocksdb::WriteBatch&)> add_to;

    /// Called once, on the committer's thread.
    ScanLog::Done done;
};

/// The only writer of the database: one thread, one queue, one synced write after another.
///
/// As each write is synced before the next one begins, only the last write in RocksDB's log can be
/// torn by a crash, which is what mend_after_crash() relies on; and RocksDB fills its memtable
/// only after the sync, so nothing reaches a table file before it is durable in the log.
/// A failed write leaves the disk unknown: from then on every change fails.
/// Thread  any.
class Committer {
public:
    /// Changes that do not free disk are refused while it has less than `disk_reserve_bytes` free.
    /// @param compactions  updated before each write
    /// @param files        checked before each write, after it, and by stats(); null for a database that is only read
    Committer(rocksdb::DB& database, std::string name, std::uint64_t disk_reserve_bytes, CompactionSwitch& compactions,
              FilesWatch* files);

    /// Writes what waits, then stops.
    ~Committer();

    Committer(const Committer&) = delete;
    Committer& operator=(const Committer&) = delete;

    void submit(Change change);

    /// The same, returning when it is durable or has failed. Not from within a `done`.
    [[nodiscard]] Result<> submit_and_wait(Change change);

    /// All but what is on disk.
    [[nodiscard]] StoreStats stats() const;

private:
    using Group = std::vector<Change>;

    void run();
    [[nodiscard]] Group next_group();
    void commit(Group group);
    void check_files();
    [[nodiscard]] Result<> write(rocksdb::WriteBatch& batch);
    void fail(Error why);
    [[nodiscard]] std::optional<std::uint64_t> free_bytes() const;
    [[nodiscard]] std::optional<Error> want_of_room(std::optional<std::uint64_t> free) const;
    void count(const Change& change);

    rocksdb::DB& database_;
    const std::string name_; // for messages, and where the disk is
    const std::uint64_t disk_reserve_bytes_;
    CompactionSwitch& compactions_;
    FilesWatch* const files_;     // or null
    std::optional<Error> failed_; // committer's thread only; stats_.last_error is its public copy
    mutable std::mutex mutex_;    // guards what follows
    std::condition_variable waiting_;
    std::deque<Change> queue_;
    bool stopping_ = false;
    StoreStats stats_;
    std::thread thread_; // last: everything it uses exists
};

} // namespace scanloom::store
