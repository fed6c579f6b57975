#include "server/store/files_watch.hpp"

#include "server/store/failure.hpp"
#include "server/store/listing.hpp"

#include <rocksdb/convenience.h>
#include <rocksdb/transaction_log.h>

#include <memory>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

std::optional<HeldFile> held(fs::path path) {
    auto file = HeldFile::open(std::move(path));
    if (!file) return std::nullopt;
    return std::move(*file);
}

} // namespace

FilesWatch::FilesWatch(rocksdb::DB& database, fs::path directory)
    : database_(database), directory_(std::move(directory)), lock_(held(directory_ / kLockFile)) {}

Result<> FilesWatch::check() {
    const std::lock_guard lock(mutex_);
    if (!lost_ && !has_its_lock()) give_up(directory_ / kLockFile);
    if (!lost_ && !has_its_log()) give_up(directory_ / "*.log");
    if (lost_) return *lost_;
    return {};
}

/// A removed session is flushed, which begins a log and deletes the one before: also between two calls here.
bool FilesWatch::has_its_log() {
    for (;;) {
        std::unique_ptr<rocksdb::LogFile> current;
        const auto status = database_.GetCurrentWalFile(&current);
        if (status.ok() && current->LogNumber() != log_number_) {
            log_number_ = current->LogNumber();
            log_ = held(directory_ / current->PathName().substr(1)); // it begins with a slash
        }
        if (status.ok() && log_ && log_->is_in_place()) return true;
        std::unique_ptr<rocksdb::LogFile> next;
        const bool has_begun_another = database_.GetCurrentWalFile(&next).ok() && next->LogNumber() != log_number_;
        if (!has_begun_another) return false;
    }
}

void FilesWatch::give_up(const fs::path& missing) {
    database_.DisableFileDeletions().PermitUncheckedError();
    rocksdb::CancelAllBackgroundWork(&database_, false);
    lost_ = failure("the store {} was deleted, moved or replaced while the server ran ({} is not the file that the "
                    "server has open): nothing is stored any more, and what was acknowledged may be gone; put the "
                    "store back, or restart the server to begin an empty one",
                    directory_.native(), missing.native());
}

} // namespace scanloom::store
