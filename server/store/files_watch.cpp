#include "server/store/files_watch.hpp"

#include "server/store/directory.hpp"
#include "server/store/store_error.hpp"

#include <rocksdb/convenience.h>
#include <rocksdb/transaction_log.h>

#include <memory>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

/// Whether the path no longer leads to the held file. Holds the file if none is held yet.
bool is_lost(std::optional<HeldFile>& file, const fs::path& path) {
    if (!file) {
        auto opened = HeldFile::open(path);
        if (!opened) return opened.error().code == Errc::kNotFound;
        file = std::move(*opened);
    }
    return !file->is_in_place();
}

} // namespace

FilesWatch::FilesWatch(rocksdb::DB& database, fs::path directory)
    : database_(database), directory_(std::move(directory)) {
    static_cast<void>(check()); // opens the files to hold
}

Result<> FilesWatch::check() {
    const std::lock_guard lock(mutex_);
    if (!lost_ && is_lost(lock_, directory_ / kLockFile)) give_up(directory_ / kLockFile);
    if (!lost_ && !has_its_log()) give_up(directory_ / "*.log");
    if (lost_) return *lost_;
    return {};
}

/// Removing a session flushes the memtable, which starts a new log and deletes the previous one. This may also happen
/// between the two calls below.
bool FilesWatch::has_its_log() {
    for (;;) {
        std::unique_ptr<rocksdb::LogFile> current;
        const auto status = database_.GetCurrentWalFile(&current);
        if (!status.ok() && !status.IsPathNotFound()) return true; // cannot be examined
        if (status.ok()) {
            if (current->LogNumber() != log_number_) log_.reset();
            log_number_ = current->LogNumber();
            if (!is_lost(log_, directory_ / current->PathName().substr(1))) return true; // the path begins with a slash
        }
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
