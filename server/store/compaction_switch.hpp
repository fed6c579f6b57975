#pragma once

#include <rocksdb/db.h>

#include <cstdint>

namespace scanloom::store {

/// Pauses RocksDB's merging of tables while the disk has little room: the merged tables exist next to the old ones for
/// a while, and would take the room that scans and removals need.
/// SetOptions() writes to the disk and waits for writes that are under way.
/// Thread  that of the committer.
class CompactionSwitch {
public:
    /// @param reserve_bytes  what the store leaves free: compactions pause below twice of it
    CompactionSwitch(rocksdb::DB& database, std::uint64_t reserve_bytes)
        : database_(database), pause_below_(2 * reserve_bytes) {}

    /// Pauses compactions, or resumes them once an eighth more than that is free.
    /// @param free_bytes  of the store's disk, now
    void update(std::uint64_t free_bytes);

    /// Stops compactions for good.
    void stop();

private:
    void set(bool paused);

    rocksdb::DB& database_;
    const std::uint64_t pause_below_;
    bool is_paused_ = false;
    bool is_stopped_ = false;
};

} // namespace scanloom::store
