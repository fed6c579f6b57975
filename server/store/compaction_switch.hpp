#pragma once

#include <rocksdb/db.h>

#include <algorithm>
#include <cstdint>

namespace scanloom::store {

/// Pauses RocksDB's merging of tables while the disk has little room: the merged tables exist next to the old ones for
/// a while, and would take the room that scans and removals need.
/// SetOptions() writes to the disk and waits for writes that are under way.
/// Thread  that of the committer.
class CompactionSwitch {
public:
    /// @param reserve_bytes  what the store leaves free: compactions pause below twice of it, and below kRoom more than
    /// it
    CompactionSwitch(rocksdb::DB& database, std::uint64_t reserve_bytes)
        : database_(database), pause_below_(reserve_bytes + std::max(reserve_bytes, kRoom)) {}

    /// What one compaction of a store of up to a gigabyte may write. Scans go on meanwhile, down to the reserve.
    static constexpr std::uint64_t kRoom = std::uint64_t{256} << 20;

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
