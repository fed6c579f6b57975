#include "server/store/compaction.hpp"

#include <utility>

namespace scanloom::store {

void CompactionSwitch::update(std::uint64_t free_bytes) {
    if (is_stopped_) return;
    if (!is_paused_ && free_bytes < pause_below_) set(true);
    if (is_paused_ && free_bytes >= pause_below_ + pause_below_ / 8) set(false);
}

void CompactionSwitch::stop() {
    is_stopped_ = true;
    set(true);
}

void CompactionSwitch::set(bool paused) {
    const auto status = database_.SetOptions({{"disable_auto_compactions", paused ? "true" : "false"}});
    if (status.ok()) is_paused_ = paused; // otherwise the next update retries
}

void CompactionWatch::set_report(Report report) {
    const std::lock_guard lock(mutex_);
    report_ = std::move(report);
    if (report_ && failed_) report_(*failed_);
}

void CompactionWatch::OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) {
    if (reason != rocksdb::BackgroundErrorReason::kCompaction) return;
    if (!error->IsCorruption() && !error->IsIOError()) return;
    const std::lock_guard lock(mutex_);
    if (!failed_ && !error->IsNoSpace()) {
        failed_ = *error;
        if (report_) report_(*failed_);
    }
    *error = rocksdb::Status::OK(); // writes continue
}

} // namespace scanloom::store
