#include "server/store/rocksdb_scan_log.hpp"

#include "server/store/log_end.hpp"
#include "server/store/record.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/convenience.h>
#include <rocksdb/experimental.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace scanloom::store {
namespace {

// Cost of a change in addition to its own bytes; keeps a flood of empty changes within the bound of a group.
constexpr std::uint64_t kChangeBytes = 64;

struct SealedPair {
    std::string key;
    std::string value;
};

SealedPair sealed_pair(std::string key, std::string value) {
    std::string sealed_value = sealed(key, std::move(value));
    return {std::move(key), std::move(sealed_value)};
}

std::uint64_t bytes_of(const std::vector<SealedPair>& pairs) {
    std::uint64_t bytes = kChangeBytes;
    for (const auto& pair : pairs) bytes += pair.key.size() + pair.value.size();
    return bytes;
}

Result<> put(rocksdb::WriteBatch& batch, const std::vector<SealedPair>& pairs) {
    for (const auto& pair : pairs) {
        if (const auto status = batch.Put(pair.key, pair.value); !status.ok()) {
            return Error{Errc::kStoreFailed, fmt::format("the store cannot take a change: {}", status.ToString())};
        }
    }
    return {};
}

Error no_such_session(SessionId session) {
    return {Errc::kNotFound, fmt::format("the store has no session {}; it may have been removed", session)};
}

Error unreadable(const std::string& store, SessionId session, const rocksdb::Status& status) {
    const auto code = code_of(status);
    return {code, fmt::format("the store {} cannot read session {}: {}; {}", store, session, status.ToString(),
                              code == Errc::kDataLoss ? kBringBackOrRemove : "look at its disk, and try again")};
}

Error damaged(const std::string& store, SessionId session, std::string_view what) {
    return {Errc::kDataLoss,
            fmt::format("the store {} is damaged: {} of session {}; {}", store, what, session, kBringBackOrRemove)};
}

std::string_view view(const rocksdb::Slice& slice) { return {slice.data(), slice.size()}; }

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

} // namespace

RocksdbScanLog::RocksdbScanLog(LockedDirectory directory, std::unique_ptr<rocksdb::DB> database, LogEnds ends,
                               std::uint64_t torn_bytes_dropped, std::shared_ptr<CompactionWatch> watch,
                               std::unique_ptr<FilesWatch> files, const StoreOptions& options)
    : directory_(std::move(directory)), database_(std::move(database)), ends_(std::move(ends)),
      torn_bytes_dropped_(torn_bytes_dropped), watch_(std::move(watch)),
      compactions_(*database_, options.disk_reserve_bytes), files_(std::move(files)), on_damage_(options.on_damage),
      committer_(*database_, name(), options.disk_reserve_bytes, compactions_, files_.get()) {
    watch_->set_report([this](const rocksdb::Status& reason) { go_on_without_compaction(reason); });
}

RocksdbScanLog::~RocksdbScanLog() { watch_->set_report(nullptr); }

/// Stops compactions, which RocksDB would otherwise retry every second without end.
void RocksdbScanLog::go_on_without_compaction(const rocksdb::Status& reason) {
    Error damage{Errc::kDataLoss,
                 fmt::format("the store {} is damaged: {}; what is stored from now on is whole, but its files are no "
                             "longer merged and use more disk; when you can, {}",
                             name(), reason.ToString(), kBringBack)};
    if (on_damage_) on_damage_(damage);
    {
        const std::lock_guard lock(damage_mutex_);
        damage_ = std::move(damage);
    }
    Change change;            // queued, because SetOptions() must not meet a write that is held back
    change.frees_disk = true; // needs no disk space at least
    change.add_to = [this](rocksdb::WriteBatch&) -> Result<> {
        compactions_.stop();
        return {};
    };
    change.done = [](const Result<>&) {};
    committer_.submit(std::move(change));
}

Result<SessionId> RocksdbScanLog::create_session(std::string_view record) {
    SessionId created = 0;
    Change change;
    change.bytes = kChangeBytes + record.size();
    change.add_to = [this, &created, record](rocksdb::WriteBatch& batch) -> Result<> {
        created = ends_.next_session;
        std::vector<SealedPair> pairs;
        pairs.push_back(sealed_pair(session_key(created), std::string(record)));
        pairs.push_back(sealed_pair(std::string(kNextSessionKey), number_bytes(created + 1)));
        if (auto added = put(batch, pairs); !added) return added;
        ends_.next_session = created + 1;
        ends_.revisions.emplace(created, 0);
        return {};
    };
    if (auto committed = committer_.submit_and_wait(std::move(change)); !committed) return committed.error();
    return created;
}

Result<std::vector<StoredSession>> RocksdbScanLog::sessions() {
    if (auto in_place = check_files(); !in_place) return in_place.error();
    std::vector<StoredSession> found;
    const KeyRange range{std::string(kSessionsBegin), std::string(kSessionsEnd)};
    const Scan scan(*database_, range);
    for (scan.iterator->Seek(range.begin); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto session = session_of(view(scan.iterator->key()));
        if (!session) return damaged(name(), 0, "the name");
        const auto record = unsealed(view(scan.iterator->key()), view(scan.iterator->value()));
        const auto damage = ends_.damaged.find(*session); // constant after opening
        found.push_back({*session,
                         record ? Result<std::string>(std::string(*record)) : damaged(name(), *session, "the record"),
                         damage == ends_.damaged.end() ? std::nullopt : std::optional(damage->second)});
    }
    if (const auto status = scan.iterator->status(); !status.ok()) {
        return Error{code_of(status),
                     fmt::format("the store {} cannot list its sessions: {}", name(), status.ToString())};
    }
    return found;
}

Result<Revision> RocksdbScanLog::end_of(SessionId session) {
    if (auto exists = check_session(session); !exists) return exists.error();
    return end_of_log(*database_, name(), session);
}

Result<> RocksdbScanLog::remove_session(SessionId session) {
    Change change;
    change.bytes = kChangeBytes;
    change.frees_disk = true;
    change.add_to = [this, session](rocksdb::WriteBatch& batch) -> Result<> {
        if (ends_.revisions.erase(session) == 0) return no_such_session(session);
        auto status = batch.Delete(session_key(session));
        for (const KeyRange& range : {entries_of(session), parts_of(session)}) {
            if (status.ok()) status = batch.DeleteRange(range.begin, range.end);
        }
        if (!status.ok()) {
            return Error{Errc::kStoreFailed, fmt::format("the store cannot take a change: {}", status.ToString())};
        }
        return {};
    };
    if (auto committed = committer_.submit_and_wait(std::move(change)); !committed) return committed;
    free_disk(session);
    return {};
}

/// Deletes tables that contain nothing else immediately. Compactions remove the rest, but only once the removal is in a
/// table: so the memtable is flushed first if there is room. A failure only costs disk space, because the remaining
/// entries belong to no session.
void RocksdbScanLog::free_disk(SessionId session) {
    if (!committer_.stats().no_room) database_->Flush({}).PermitUncheckedError();
    for (const KeyRange& range : {entries_of(session), parts_of(session)}) {
        const rocksdb::Slice begin(range.begin);
        const rocksdb::Slice end(range.end);
        rocksdb::DeleteFilesInRange(database_.get(), database_->DefaultColumnFamily(), &begin, &end, false)
            .PermitUncheckedError();
        rocksdb::experimental::SuggestCompactRange(database_.get(), &begin, &end).PermitUncheckedError();
    }
}

void RocksdbScanLog::append(SessionId session, Revision first, std::vector<std::string> entries, Done done) {
    // Sealed on the caller's thread, because one committer serves all sessions.
    std::vector<SealedPair> pairs;
    pairs.reserve(entries.size());
    for (auto& entry : entries)
        pairs.push_back(sealed_pair(entry_key(session, first + pairs.size()), std::move(entry)));

    Change change;
    change.bytes = bytes_of(pairs);
    change.appends = 1;
    change.entries = pairs.size();
    change.add_to = [this, session, first, pairs = std::move(pairs)](rocksdb::WriteBatch& batch) -> Result<> {
        const auto end = ends_.revisions.find(session);
        if (end == ends_.revisions.end()) return no_such_session(session);
        if (const auto damage = ends_.damaged.find(session); damage != ends_.damaged.end()) return damage->second;
        if (first != end->second + 1) {
            return Error{Errc::kConflict, fmt::format("an append to session {} begins with revision {}, but its log "
                                                      "ends with {}",
                                                      session, first, end->second)};
        }
        if (auto added = put(batch, pairs); !added) return added;
        end->second += pairs.size();
        return {};
    };
    change.done = std::move(done);
    committer_.submit(std::move(change));
}

Result<> RocksdbScanLog::read(SessionId session, Revision after, const VisitEntry& visit) {
    if (auto exists = check_session(session); !exists) return exists;
    const KeyRange range = entries_of(session);
    const Scan scan(*database_, range);
    // Starts with the entry before, to check that the log reaches that far.
    Revision expected = after == 0 ? 1 : after;
    for (scan.iterator->Seek(entry_key(session, expected)); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto key = view(scan.iterator->key());
        if (revision_of(key) != expected) {
            return damaged(name(), session, fmt::format("the entry of revision {} is missing", expected));
        }
        const auto entry = unsealed(key, view(scan.iterator->value()));
        if (!entry) return damaged(name(), session, fmt::format("the entry of revision {}", expected));
        if (expected > after) {
            if (auto visited = visit(expected, *entry); !visited) return visited;
        }
        ++expected;
    }
    if (const auto status = scan.iterator->status(); !status.ok()) {
        return prefixed(fmt::format("at revision {}: ", expected), unreadable(name(), session, status));
    }
    if (expected == after) {
        return damaged(name(), session, fmt::format("the log ends before revision {}", after));
    }
    return {};
}

Result<> RocksdbScanLog::clear_checkpoint(SessionId session) {
    Change change;
    change.bytes = kChangeBytes;
    change.add_to = [this, session](rocksdb::WriteBatch& batch) -> Result<> {
        if (!ends_.revisions.contains(session)) return no_such_session(session);
        const KeyRange range = parts_of(session);
        if (const auto status = batch.DeleteRange(range.begin, range.end); !status.ok()) {
            return Error{Errc::kStoreFailed, fmt::format("the store cannot take a change: {}", status.ToString())};
        }
        return {};
    };
    return committer_.submit_and_wait(std::move(change));
}

Result<> RocksdbScanLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    std::vector<SealedPair> pairs;
    pairs.reserve(parts.size());
    for (auto& part : parts) pairs.push_back(sealed_pair(part_key(session, part.key), std::move(part.value)));

    Change change;
    change.bytes = bytes_of(pairs);
    change.add_to = [this, session, pairs = std::move(pairs)](rocksdb::WriteBatch& batch) -> Result<> {
        if (!ends_.revisions.contains(session)) return no_such_session(session);
        return put(batch, pairs);
    };
    return committer_.submit_and_wait(std::move(change));
}

Result<> RocksdbScanLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    if (auto exists = check_session(session); !exists) return exists;
    const KeyRange range = parts_of(session);
    const Scan scan(*database_, range);
    for (scan.iterator->Seek(range.begin); scan.iterator->Valid(); scan.iterator->Next()) {
        const auto part = part_of(view(scan.iterator->key()));
        const auto value = unsealed(view(scan.iterator->key()), view(scan.iterator->value()));
        if (!part || !value) return damaged(name(), session, "a part of the checkpoint");
        if (auto visited = visit(*part, *value); !visited) return visited;
    }
    if (const auto status = scan.iterator->status(); !status.ok()) return unreadable(name(), session, status);
    return {};
}

Result<> RocksdbScanLog::copy_with(const CopyDatabase& copy) {
    if (const auto failed = stats().last_error) return Error{Errc::kStoreFailed, *failed};
    return copy(*database_);
}

StoreStats RocksdbScanLog::stats() const {
    StoreStats stats = committer_.stats();
    stats.torn_bytes_dropped = torn_bytes_dropped_;
    const std::lock_guard lock(damage_mutex_);
    if (damage_) stats.damage = damage_->message;
    return stats;
}

std::uint64_t RocksdbScanLog::bytes_on_disk() const { return bytes_in(directory_.path()); }

/// RocksDB opens tables by path, so it would read a store that took the place of this one.
Result<> RocksdbScanLog::check_files() { return files_ ? files_->check() : Result<>(); }

Result<> RocksdbScanLog::check_session(SessionId session) {
    if (auto in_place = check_files(); !in_place) return in_place;
    std::string record;
    const auto status = database_->Get({}, session_key(session), &record);
    if (status.ok()) return {};
    if (status.IsNotFound()) return no_such_session(session);
    return unreadable(name(), session, status);
}

} // namespace scanloom::store
