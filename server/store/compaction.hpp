#pragma once

#include <rocksdb/db.h>
#include <rocksdb/listener.h>
#include <rocksdb/table_properties.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

/// Compactions, with which RocksDB merges its tables in the background: paused while the disk is full, not fatal if
/// they fail, and begun where they remove data.
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

/// Keeps one damaged table from stopping the whole store.
///
/// RocksDB compacts its tables in the background and accepts no more writes after a compaction failed. New entries go
/// to new files, which old damage does not affect. This listener therefore reports an unreadable table to the store and
/// lets RocksDB continue writing. A full disk is not damage: writes continue while there is room, and CompactionSwitch
/// pauses compactions.
///
/// Threads: any.
/// Source: RocksDB 7.8, listener.h, EventListener::OnBackgroundError.
class CompactionWatch final : public rocksdb::EventListener {
public:
    using Report = std::function<void(const rocksdb::Status&)>;

    /// Sets the function that is called once, from a RocksDB thread, when tables can no longer be compacted; calls it
    /// immediately if that is already known. Null removes the function and waits for a call in progress.
    void set_report(Report report);

    void OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) override;

private:
    std::mutex mutex_;
    std::optional<rocksdb::Status> failed_;
    Report report_;
};

/// Returns what marks each new table that holds the removal of a range of keys for compaction. Compactions then carry
/// the removal down to the last level, whatever else is merged meanwhile, and so free the disk space of removed
/// sessions. Without marks, a removal stays in an upper level until enough is written after it.
/// Source: RocksDB 7.8, table_properties.h, TablePropertiesCollector::NeedCompact.
[[nodiscard]] std::shared_ptr<rocksdb::TablePropertiesCollectorFactory> compaction_of_removals();

} // namespace scanloom::store
