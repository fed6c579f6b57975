#include "server/store/reopening_log.hpp"

#include "server/store/directory.hpp"
#include "server/store/files_watch.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

void add(StoreStats& to, const StoreStats& from) {
    to.appends += from.appends;
    to.entries += from.entries;
    to.synced_writes += from.synced_writes;
    to.torn_bytes_dropped += from.torn_bytes_dropped;
}

/// Checks that a file can be written and synced in the directory, and that `bytes_free` bytes are free.
Result<> can_be_written(const std::filesystem::path& directory, std::uint64_t bytes_free) {
    const auto why_not = [&](std::string_view reason) {
        return Error{Errc::kStoreFailed,
                     fmt::format("the disk of the store {} cannot be written: {}", directory.native(), reason)};
    };
    std::error_code failed;
    const auto space = std::filesystem::space(directory, failed);
    if (failed) return why_not(failed.message());
    if (space.available < bytes_free) return why_not(fmt::format("{} MiB are free", space.available >> 20));

    const auto path = directory / "probe.dbtmp"; // the listing of a store ignores this extension
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file < 0) return why_not(std::system_category().message(errno));
    const std::string page(4096, 'p');
    const bool written = ::write(file, page.data(), page.size()) == static_cast<ssize_t>(page.size());
    const bool synced = written && ::fsync(file) == 0;
    const int problem = errno;
    ::close(file);
    ::unlink(path.c_str());
    if (!synced) return why_not(std::system_category().message(problem));
    return {};
}

/// Returns the room needed to open: it writes the entries of the write-ahead logs to tables before it deletes the logs.
std::uint64_t bytes_to_open(const std::filesystem::path& directory) {
    std::uint64_t bytes = 1 << 20;
    for (const auto& log : regular_files(directory, ".log")) {
        std::error_code gone;
        const auto size = std::filesystem::file_size(log, gone);
        if (!gone) bytes += size;
    }
    return bytes;
}

} // namespace

Result<std::unique_ptr<ReopeningLog>> ReopeningLog::open(Open open, Check disk_is_well) {
    auto log = open();
    if (!log) return log.error();
    return std::unique_ptr<ReopeningLog>(new ReopeningLog(std::move(*log), std::move(open), std::move(disk_is_well)));
}

bool ReopeningLog::try_again() {
    if (!stats().last_error) return false;
    if (disk_is_well_ && !disk_is_well_()) return false;
    const std::unique_lock lock(mutex_);
    if (log_) {
        const auto last = log_->stats();
        add(before_, last);
        before_.last_error = last.last_error;
        log_.reset(); // first, because opening needs the directory's lock
    }
    auto opened = open_();
    if (!opened) {
        before_.last_error = opened.error().message;
        return false;
    }
    log_ = std::move(*opened);
    before_.last_error.reset();
    return true;
}

Error ReopeningLog::closed() const {
    return {Errc::kStoreFailed, fmt::format("the store is being opened again after it had failed: {}",
                                            before_.last_error.value_or("try again later"))};
}

template <class Use>
auto ReopeningLog::use(const Use& what) -> decltype(what(std::declval<ScanLog&>())) {
    const std::shared_lock lock(mutex_);
    if (!log_) return closed();
    return what(*log_);
}

Result<SessionId> ReopeningLog::create_session(std::string_view record) {
    return use([&](ScanLog& log) { return log.create_session(record); });
}

Result<std::vector<StoredSession>> ReopeningLog::sessions() {
    return use([&](ScanLog& log) { return log.sessions(); });
}

Result<Revision> ReopeningLog::end_of(SessionId session) {
    return use([&](ScanLog& log) { return log.end_of(session); });
}

Result<> ReopeningLog::remove_session(SessionId session) {
    return use([&](ScanLog& log) { return log.remove_session(session); });
}

void ReopeningLog::append(SessionId session, Revision first, std::vector<std::string> entries, Done done) {
    const std::shared_lock lock(mutex_, std::try_to_lock);
    if (lock && log_) return log_->append(session, first, std::move(entries), std::move(done));
    done(Error{Errc::kStoreFailed, "the store is being opened again after it had failed; try again later"});
}

Result<> ReopeningLog::read(SessionId session, Revision after, const VisitEntry& visit) {
    auto read = use([&](ScanLog& log) { return log.read(session, after, visit); });
    if (!read && (read.error().code == Errc::kDataLoss || read.error().code == Errc::kStoreFailed)) {
        on_unreadable_(session, read.error());
    }
    return read;
}

Result<> ReopeningLog::clear_checkpoint(SessionId session) {
    return use([&](ScanLog& log) { return log.clear_checkpoint(session); });
}

Result<> ReopeningLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    return use([&](ScanLog& log) { return log.write_checkpoint(session, std::move(parts)); });
}

Result<> ReopeningLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    return use([&](ScanLog& log) { return log.read_checkpoint(session, visit); });
}

Result<> ReopeningLog::copy_with(const CopyDatabase& copy) {
    return use([&](ScanLog& log) { return log.copy_with(copy); });
}

StoreStats ReopeningLog::stats() const {
    const std::shared_lock lock(mutex_);
    StoreStats stats = log_ ? log_->stats() : StoreStats{};
    add(stats, before_);
    if (before_.last_error) stats.last_error = before_.last_error;
    return stats;
}

std::uint64_t ReopeningLog::bytes_on_disk() const {
    const std::shared_lock lock(mutex_);
    return log_ ? log_->bytes_on_disk() : 0;
}

Result<std::unique_ptr<ReopeningLog>> open_reopening(const std::filesystem::path& directory,
                                                     const StoreOptions& options, const OpenStore& open) {
    const auto lock = std::make_shared<std::optional<HeldFile>>(); // lock file of the store that was opened first
    auto log = ReopeningLog::open([=] { return open(directory, options); },
                                  [=]() -> Result<> {
                                      if (!(*lock)->is_in_place()) return failure("another store is in its place");
                                      return can_be_written(directory, bytes_to_open(directory));
                                  });
    if (!log) return log;
    auto held = HeldFile::open(directory / kLockFile);
    if (!held) return held.error();
    *lock = std::move(*held);
    if (const auto lost = (*log)->stats().last_error) return failure("{}", *lost);
    return log;
}

} // namespace scanloom::store
