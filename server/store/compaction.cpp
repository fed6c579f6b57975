#include "server/store/compaction.hpp"

#include <utility>

namespace scanloom::store {
namespace {

/// Marks a table that holds the removal of a range.
class RemovalMark final : public rocksdb::TablePropertiesCollector {
public:
    rocksdb::Status AddUserKey(const rocksdb::Slice&, const rocksdb::Slice&, rocksdb::EntryType type,
                               rocksdb::SequenceNumber, std::uint64_t) override {
        if (type == rocksdb::kEntryRangeDeletion) has_removal_ = true;
        return rocksdb::Status::OK();
    }

    bool NeedCompact() const override { return has_removal_; }
    rocksdb::Status Finish(rocksdb::UserCollectedProperties*) override { return rocksdb::Status::OK(); }
    rocksdb::UserCollectedProperties GetReadableProperties() const override { return {}; }
    const char* Name() const override { return "RemovalMark"; }

private:
    bool has_removal_ = false;
};

class RemovalMarks final : public rocksdb::TablePropertiesCollectorFactory {
public:
    rocksdb::TablePropertiesCollector* CreateTablePropertiesCollector(Context) override { return new RemovalMark; }
    const char* Name() const override { return "RemovalMarks"; }
};

} // namespace

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

std::shared_ptr<rocksdb::TablePropertiesCollectorFactory> compaction_of_removals() {
    return std::make_shared<RemovalMarks>();
}

} // namespace scanloom::store
