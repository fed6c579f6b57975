#pragma once

#include "common/error/error.hpp"

#include <rocksdb/listener.h>

#include <functional>
#include <mutex>
#include <optional>

namespace scanloom::store {

/// Keeps one damaged table from stopping the whole store.
///
/// RocksDB merges its tables in the background, and takes no more writes once that has failed. But new
/// entries go to new files, which old damage does not touch: so a table that cannot be read is reported
/// to the store, and RocksDB goes on writing. A full disk is no damage: writes go on as far as there is room, and
/// CompactionSwitch pauses the merging.
///
/// Thread  any.
/// Source  RocksDB 7.8, listener.h, EventListener::OnBackgroundError.
class CompactionWatch final : public rocksdb::EventListener {
public:
    using Tell = std::function<void(const rocksdb::Status&)>;

    /// Calls `tell` once, from a thread of RocksDB, when tables can be merged no more; at once if that is
    /// known already. Null: tells nobody any longer, also not at this moment.
    void set_tell(Tell tell);

    void OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) override;

private:
    std::mutex mutex_;
    std::optional<rocksdb::Status> failed_;
    Tell tell_;
};

} // namespace scanloom::store
