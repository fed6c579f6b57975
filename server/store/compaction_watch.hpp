#pragma once

#include "common/error/error.hpp"

#include <rocksdb/listener.h>

#include <functional>
#include <mutex>
#include <optional>

namespace scanloom::store {

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
    using Tell = std::function<void(const rocksdb::Status&)>;

    /// Sets the function that is called once, from a RocksDB thread, when tables can no longer be compacted; calls it
    /// immediately if that is already known. Null removes the function and waits for a call in progress.
    void set_tell(Tell tell);

    void OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) override;

private:
    std::mutex mutex_;
    std::optional<rocksdb::Status> failed_;
    Tell tell_;
};

} // namespace scanloom::store
