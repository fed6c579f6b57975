#pragma once

#include <rocksdb/db.h>

#include <algorithm>
#include <cstdint>

namespace scanloom::store {

/// Pauses RocksDB's compactions while the disk has little room. Merged tables exist next to the old ones for a while
/// and would take the room that scans and removals need.
/// Cost: a change of state calls SetOptions(), which writes to the disk and waits for writes in progress.
/// Threads: the committer's.
class CompactionSwitch {
public:
    /// @param reserve_bytes  what the store leaves free. Compactions pause below twice this value, and below kRoom more
    ///                       than it.
    CompactionSwitch(rocksdb::DB& database, std::uint64_t reserve_bytes)
        : database_(database), pause_below_(reserve_bytes + std::max(reserve_bytes, kRoom)) {}

    /// What one compaction of a store of up to 1 GB may write. Scans are still stored meanwhile, down to the reserve.
    static constexpr std::uint64_t kRoom = std::uint64_t{256} << 20;

    /// Pauses compactions, or resumes them once an eighth more than the limit is free.
    /// @param free_bytes  of the store's disk, now
    void update(std::uint64_t free_bytes);

    /// Stops compactions permanently.
    void stop();

private:
    void set(bool paused);

    rocksdb::DB& database_;
    const std::uint64_t pause_below_;
    bool is_paused_ = false;
    bool is_stopped_ = false;
};

} // namespace scanloom::store
