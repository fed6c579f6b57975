#include "server/store/rocksdb_scan_log.hpp"

#include "server/store/backup_engine.hpp"
#include "server/store/files.hpp"
#include "server/store/record.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

// Cost of a change in addition to its own bytes; keeps a flood of empty changes within the bound of a group.
constexpr std::uint64_t kChangeBytes = 64;

/// Returns whether a batch accepted an operation.
Result<> accepted(const rocksdb::Status& status) {
    if (status.ok()) return {};
    return failure("the store cannot accept a change: {}", status.ToString());
}

/// Keys with their sealed values.
class SealedPairs {
public:
    void add(std::string key, std::string value) {
        std::string sealed_value = sealed(key, std::move(value));
        bytes_ += key.size() + sealed_value.size();
        pairs_.emplace_back(std::move(key), std::move(sealed_value));
    }

    [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }

    /// Returns the approximate size of a change that writes the pairs.
    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

    [[nodiscard]] Result<> put(rocksdb::WriteBatch& batch) const {
        for (const auto& [key, value] : pairs_) {
            if (auto put = accepted(batch.Put(key, value)); !put) return put;
        }
        return {};
    }

private:
    std::vector<std::pair<std::string, std::string>> pairs_;
    std::uint64_t bytes_ = kChangeBytes;
};

Error unreadable(const std::string& store, SessionId session, const rocksdb::Status& status) {
    const auto code = code_of(status);
    return {code, fmt::format("the store {} cannot read session {}: {}; {}", store, session, status.ToString(),
                              code == Errc::kDataLoss ? kRecoverOrRemove : "check its disk, and try again")};
}

Error damaged(const std::string& store, SessionId session, std::string_view what) {
    return {Errc::kDataLoss,
            fmt::format("the store {} is damaged: {} of session {}; {}", store, what, session, kRecoverOrRemove)};
}

/// A log is read once, front to end, so the cache need not keep any of it.
struct Scan {
    explicit Scan(rocksdb::DB& database, const KeyRange& range)
        : end(range.end), iterator(database.NewIterator(options(&end))) {}

    static rocksdb::ReadOptions options(const rocksdb::Slice* end) {
        rocksdb::ReadOptions read;
        read.iterate_upper_bound = end;
        read.fill_cache = false;
        return read;
    }

    rocksdb::Slice end;
    std::unique_ptr<rocksdb::Iterator> iterator;
};

void add(StoreStats& to, const StoreStats& from) {
    to.appends += from.appends;
    to.entries += from.entries;
    to.synced_writes += from.synced_writes;
    to.torn_bytes_dropped += from.torn_bytes_dropped;
}

} // namespace

Result<std::unique_ptr<ScanLog>> RocksdbScanLog::open(const fs::path& directory, LockedDirectory::Files files,
                                                      const StoreOptions& options) {
    auto database = Database::open(directory, files, options);
    if (!database) return database.error();
    auto log = std::make_unique<RocksdbScanLog>(std::move(*database), options);
    auto lock_file = HeldFile::open(directory / kLockFile);
    if (!lock_file) return lock_file.error();
    log->files_ = files;
    log->lock_file_ = std::move(*lock_file);
    if (const auto lost = log->stats().last_error) return failure("{}", *lost);
    return log;
}

RocksdbScanLog::RocksdbScanLog(std::unique_ptr<Database> database, const StoreOptions& options)
    : directory_(database->name()), options_(options), database_(std::move(database)) {}

Result<RocksdbScanLog::Use> RocksdbScanLog::use() const {
    std::shared_lock lock(mutex_);
    if (database_) return Use{std::move(lock), *database_};
    return failure("the store failed and is being reopened: {}", before_.last_error.value_or("try again later"));
}

/// Errors: kNotFound: there is no such session; kDataLoss, kStoreFailed: its record cannot be read.
Result<RocksdbScanLog::Use> RocksdbScanLog::use_for(SessionId session) const {
    auto use = this->use();
    if (!use) return use;
    if (auto in_place = use->database.check_files(); !in_place) return in_place.error();
    std::string record;
    const auto status = use->database.rocksdb().Get({}, session_key(session), &record);
    if (status.ok()) return use;
    if (status.IsNotFound()) return no_such_session(session);
    return unreadable(use->database.name(), session, status);
}

/// Commits a change and waits until it is durable.
/// @param bytes       its approximate size
/// @param frees_disk  whether it is accepted when the disk has no room
Result<> RocksdbScanLog::commit(std::uint64_t bytes, const AddTo& add_to, bool frees_disk) {
    const auto use = this->use();
    if (!use) return use.error();
    Change change;
    change.bytes = bytes;
    change.frees_disk = frees_disk;
    change.add_to = [&ends = use->database.ends(), &add_to](rocksdb::WriteBatch& batch) { return add_to(ends, batch); };
    return use->database.committer().submit_and_wait(std::move(change));
}

Result<SessionId> RocksdbScanLog::create_session(std::string_view record) {
    SessionId created = 0;
    const auto committed =
        commit(kChangeBytes + record.size(), [&](LogEnds& ends, rocksdb::WriteBatch& batch) -> Result<> {
            created = ends.next_session;
            SealedPairs pairs;
            pairs.add(session_key(created), std::string(record));
            pairs.add(std::string(kNextSessionKey), number_bytes(created + 1));
            if (auto added = pairs.put(batch); !added) return added;
            ends.next_session = created + 1;
            ends.revisions.emplace(created, 0);
            return {};
        });
    if (!committed) return committed.error();
    return created;
}

Result<std::vector<StoredSession>> RocksdbScanLog::sessions() {
    const auto use = this->use();
    if (!use) return use.error();
    Database& database = use->database;
    if (auto in_place = database.check_files(); !in_place) return in_place.error();
    std::vector<StoredSession> found;
    const auto& damaged_ends = database.ends().damaged;
    const KeyRange range{std::string(kSessionsBegin), std::string(kSessionsEnd)};
    const Scan scan(database.rocksdb(), range);
    for (scan.iterator->Seek(range.begin); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto session = session_of(scan.iterator->key().ToStringView());
        if (!session) return damaged(database.name(), 0, "the name");
        const auto record = unsealed(scan.iterator->key().ToStringView(), scan.iterator->value().ToStringView());
        const auto damage = damaged_ends.find(*session);
        found.push_back(
            {*session,
             record ? Result<std::string>(std::string(*record)) : damaged(database.name(), *session, "the record"),
             damage == damaged_ends.end() ? std::nullopt : std::optional(damage->second)});
    }
    if (const auto status = scan.iterator->status(); !status.ok()) {
        return Error{code_of(status),
                     fmt::format("the store {} cannot list its sessions: {}", database.name(), status.ToString())};
    }
    return found;
}

Result<Revision> RocksdbScanLog::end_of(SessionId session) {
    const auto use = use_for(session);
    if (!use) return use.error();
    return end_of_log(use->database.rocksdb(), use->database.name(), session);
}

Result<> RocksdbScanLog::remove_session(SessionId session) {
    const auto remove = [session](LogEnds& ends, rocksdb::WriteBatch& batch) -> Result<> {
        if (ends.revisions.erase(session) == 0) return no_such_session(session);
        auto status = batch.Delete(session_key(session));
        for (const KeyRange& range : {entries_of(session), parts_of(session)}) {
            if (status.ok()) status = batch.DeleteRange(range.begin, range.end);
        }
        return accepted(status);
    };
    if (auto committed = commit(kChangeBytes, remove, true); !committed) return committed;
    if (const auto use = this->use()) use->database.free_disk(session);
    return {};
}

void RocksdbScanLog::append(SessionId session, Revision first, std::vector<std::string> entries, Done done) {
    // Sealed on the caller's thread, because one committer serves all sessions.
    SealedPairs pairs;
    for (auto& entry : entries) pairs.add(entry_key(session, first + pairs.size()), std::move(entry));

    const std::shared_lock lock(mutex_, std::try_to_lock);
    if (!lock || !database_) {
        return done(Error{Errc::kStoreFailed, "the store failed and is being reopened; try again later"});
    }
    LogEnds& ends = database_->ends();
    Change change;
    change.bytes = pairs.bytes();
    change.appends = 1;
    change.entries = pairs.size();
    change.add_to = [&ends, session, first, pairs = std::move(pairs)](rocksdb::WriteBatch& batch) -> Result<> {
        const auto end = ends.revisions.find(session);
        if (end == ends.revisions.end()) return no_such_session(session);
        if (const auto damage = ends.damaged.find(session); damage != ends.damaged.end()) return damage->second;
        if (first != end->second + 1) {
            return Error{Errc::kConflict, fmt::format("an append to session {} begins with revision {}, but its log "
                                                      "ends with {}",
                                                      session, first, end->second)};
        }
        if (auto added = pairs.put(batch); !added) return added;
        end->second += pairs.size();
        return {};
    };
    change.done = std::move(done);
    database_->committer().submit(std::move(change));
}

Result<> RocksdbScanLog::read(SessionId session, Revision after, const VisitEntry& visit) {
    auto read = read_entries(session, after, visit);
    if (!read && options_.on_unreadable &&
        (read.error().code == Errc::kDataLoss || read.error().code == Errc::kStoreFailed)) {
        options_.on_unreadable(session, read.error());
    }
    return read;
}

Result<> RocksdbScanLog::read_entries(SessionId session, Revision after, const VisitEntry& visit) {
    const auto use = use_for(session);
    if (!use) return use.error();
    Database& database = use->database;
    const KeyRange range = entries_of(session);
    const Scan scan(database.rocksdb(), range);
    // Starts with the entry before, to check that the log reaches that far.
    Revision expected = after == 0 ? 1 : after;
    for (scan.iterator->Seek(entry_key(session, expected)); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto key = scan.iterator->key().ToStringView();
        if (revision_of(key) != expected) {
            return damaged(database.name(), session, fmt::format("the entry of revision {} is missing", expected));
        }
        const auto entry = unsealed(key, scan.iterator->value().ToStringView());
        if (!entry) return damaged(database.name(), session, fmt::format("the entry of revision {}", expected));
        if (expected > after) {
            const auto visited = visit(expected, *entry);
            if (!visited) return visited.error();
            if (*visited == Visit::kStop) return {};
        }
        ++expected;
    }
    if (const auto status = scan.iterator->status(); !status.ok()) {
        return prefixed(fmt::format("at revision {}: ", expected), unreadable(database.name(), session, status));
    }
    if (expected == after) {
        return damaged(database.name(), session, fmt::format("the log ends before revision {}", after));
    }
    return {};
}

Result<> RocksdbScanLog::clear_checkpoint(SessionId session) {
    return commit(kChangeBytes, [session](LogEnds& ends, rocksdb::WriteBatch& batch) -> Result<> {
        if (!ends.revisions.contains(session)) return no_such_session(session);
        const KeyRange range = parts_of(session);
        return accepted(batch.DeleteRange(range.begin, range.end));
    });
}

Result<> RocksdbScanLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    SealedPairs pairs;
    for (auto& part : parts) pairs.add(part_key(session, part.key), std::move(part.value));
    return commit(pairs.bytes(), [session, &pairs](LogEnds& ends, rocksdb::WriteBatch& batch) -> Result<> {
        return ends.revisions.contains(session) ? pairs.put(batch) : no_such_session(session);
    });
}

Result<> RocksdbScanLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    const auto use = use_for(session);
    if (!use) return use.error();
    Database& database = use->database;
    const KeyRange range = parts_of(session);
    const Scan scan(database.rocksdb(), range);
    for (scan.iterator->Seek(range.begin); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto part = part_of(scan.iterator->key().ToStringView());
        const auto value = unsealed(scan.iterator->key().ToStringView(), scan.iterator->value().ToStringView());
        if (!part || !value) return damaged(database.name(), session, "a part of the checkpoint");
        if (auto visited = visit(*part, *value); !visited) return visited;
    }
    if (const auto status = scan.iterator->status(); !status.ok()) return unreadable(database.name(), session, status);
    return {};
}

bool RocksdbScanLog::reopen() {
    if (!lock_file_ || !stats().last_error) return false;
    if (!lock_file_->is_in_place() || !Database::can_be_opened(directory_, options_)) return false;
    const std::unique_lock lock(mutex_);
    if (database_) {
        const auto last = database_->stats();
        add(before_, last);
        before_.last_error = last.last_error;
        database_.reset(); // first, because opening needs the directory's lock
    }
    auto opened = Database::open(directory_, files_, options_);
    if (!opened) {
        before_.last_error = opened.error().message;
        return false;
    }
    database_ = std::move(*opened);
    before_.last_error.reset();
    return true;
}

StoreStats RocksdbScanLog::stats() const {
    const std::shared_lock lock(mutex_);
    StoreStats stats = database_ ? database_->stats() : StoreStats{};
    add(stats, before_);
    if (before_.last_error) stats.last_error = before_.last_error;
    return stats;
}

Result<std::string> RocksdbScanLog::identity() {
    const auto use = this->use();
    if (!use) return use.error();
    return identity_of(use->database.rocksdb());
}

Result<> RocksdbScanLog::backup_to(const fs::path& directory, const std::stop_token& stop) {
    const auto found = sessions();
    if (!found) return found.error();
    const auto use = this->use();
    if (!use) return use.error();
    if (const auto failed = use->database.stats().last_error) return failure("{}", *failed);
    return back_up(use->database.rocksdb(), directory, found->size(), stop);
}

std::uint64_t RocksdbScanLog::bytes_on_disk() const { return bytes_in(directory_); }

} // namespace scanloom::store
