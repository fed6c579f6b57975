#pragma once

#include "server/store/compaction.hpp"
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
    std::uint64_t bytes = 0;   ///< approximate size in the write
    std::uint64_t appends = 0; ///< added to the statistics when the change is durable
    std::uint64_t entries = 0;
    bool frees_disk = false; ///< accepted even when less than the reserve is free

    /// Adds the change to the write, or returns an error and adds nothing. Called on the committer's thread, in order
    /// of submission.
    std::function<Result<>(rocksdb::WriteBatch&)> add_to;

    /// Called exactly once, on the committer's thread.
    ScanLog::Done done;
};

/// The only writer of the database: one thread with one queue issues one synced write after another.
///
/// Each write is synced before the next one begins, so a crash can tear only the last write in RocksDB's log;
/// cut_off_unfinished_write() relies on this. RocksDB fills its memtable only after the sync, so nothing reaches a
/// table file before it is durable in the log. A failed write leaves the disk in an unknown state: every later change
/// fails.
/// Threads: any.
class Committer {
public:
    /// Refuses changes that do not free disk while less than `disk_reserve_bytes` are free.
    /// @param name         directory of the store, for messages and to find its disk
    /// @param compactions  updated before each write
    /// @param files        checked before and after each write and by stats(); null for a read-only database
    Committer(rocksdb::DB& database, std::string name, std::uint64_t disk_reserve_bytes, CompactionSwitch& compactions,
              FilesWatch* files);

    /// Writes the queued changes, then stops.
    ~Committer();

    Committer(const Committer&) = delete;
    Committer& operator=(const Committer&) = delete;

    void submit(Change change);

    /// Submits a change and waits until it is durable or has failed; replaces its `done`. Not called from within a
    /// `done`.
    [[nodiscard]] Result<> submit_and_wait(Change change);

    /// Returns the committer's counts and errors; torn_bytes_dropped and damage stay unset.
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
    [[nodiscard]] std::optional<Error> shortage(std::optional<std::uint64_t> free) const;
    void count(const Change& change);

    rocksdb::DB& database_;
    const std::string name_; // directory of the store
    const std::uint64_t disk_reserve_bytes_;
    CompactionSwitch& compactions_;
    FilesWatch* const files_;     // may be null
    std::optional<Error> failed_; // used on the committer's thread only; stats_.last_error is its public copy
    mutable std::mutex mutex_;    // guards the members below
    std::condition_variable waiting_;
    std::deque<Change> queue_;
    bool stopping_ = false;
    StoreStats stats_;
    std::thread thread_; // last: starts after everything that it uses
};

} // namespace scanloom::store
