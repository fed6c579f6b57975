#include "server/store/compaction_watch.hpp"

#include <utility>

namespace scanloom::store {

void CompactionWatch::set_tell(Tell tell) {
    const std::lock_guard lock(mutex_);
    tell_ = std::move(tell);
    if (tell_ && failed_) tell_(*failed_);
}

void CompactionWatch::OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) {
    if (reason != rocksdb::BackgroundErrorReason::kCompaction) return;
    if (!error->IsCorruption() && !error->IsIOError()) return;
    const std::lock_guard lock(mutex_);
    if (!failed_ && !error->IsNoSpace()) {
        failed_ = *error;
        if (tell_) tell_(*failed_);
    }
    *error = rocksdb::Status::OK(); // writes continue
}

} // namespace scanloom::store
