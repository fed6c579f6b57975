#include "server/store/database.hpp"

#include "server/store/crash_recovery.hpp"
#include "server/store/files.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/convenience.h>
#include <rocksdb/env.h>

#include <set>
#include <string_view>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

/// Reads a number that the store keeps about itself; nullopt if it was never written.
Result<std::optional<std::uint64_t>> read_number(rocksdb::DB& database, const fs::path& directory,
                                                 std::string_view key) {
    std::string sealed_value;
    const auto status = database.Get({}, rocksdb::Slice(key.data(), key.size()), &sealed_value);
    if (status.IsNotFound()) return std::optional<std::uint64_t>{};
    if (!status.ok()) return cannot_open(directory, status);
    const auto value = unsealed(key, sealed_value);
    const auto number = value ? number_of(*value) : std::nullopt;
    if (!number) {
        return failure("the store {} cannot be opened: its record '{}' is damaged; {}", directory.native(), key,
                       kRecover);
    }
    return number;
}

bool is_empty(rocksdb::DB& database) {
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    iterator->SeekToFirst();
    return !iterator->Valid() && iterator->status().ok();
}

/// Whether the format record has to be written: the database is empty or of an earlier format.
/// Errors: kUnsupportedVersion: it is of a newer format; kStoreFailed: it belongs to another program or is damaged.
Result<bool> must_write_format(rocksdb::DB& database, const fs::path& directory) {
    const auto version = read_number(database, directory, kFormatKey);
    if (!version) return version.error();
    if (!*version) {
        if (is_empty(database)) return true;
        return failure("the store {} cannot be opened: it holds a RocksDB database without the format record of "
                       "scanloom-server; name another directory if it is another program's; if it is not, {}",
                       directory.native(), kRecover);
    }
    if (**version <= kFormatVersion) return **version < kFormatVersion;
    return Error{Errc::kUnsupportedVersion,
                 fmt::format("the store {} was written by a newer scanloom-server (format {}, this one knows up to "
                             "{}); update the server",
                             directory.native(), **version, kFormatVersion)};
}

Result<> write_format_if_needed(rocksdb::DB& database, const fs::path& directory) {
    const auto must_write = must_write_format(database, directory);
    if (!must_write) return must_write.error();
    if (!*must_write) return {};
    rocksdb::WriteOptions options;
    options.sync = true;
    const std::string key(kFormatKey);
    const auto status = database.Put(options, key, sealed(key, number_bytes(kFormatVersion)));
    if (!status.ok()) return cannot_open(directory, status);
    return {};
}

/// Reads the end of each session's log and the id of the next session. Damage of one session is part of the result.
/// Errors: kStoreFailed: the record that numbers sessions is damaged.
Result<LogEnds> read_ends(rocksdb::DB& database, const fs::path& directory) {
    LogEnds ends;
    const auto next = read_number(database, directory, kNextSessionKey);
    if (!next) return next.error();
    ends.next_session = next->value_or(1);

    const std::unique_ptr<rocksdb::Iterator> sessions(database.NewIterator({}));
    for (sessions->Seek(std::string(kSessionsBegin)); sessions->Valid(); sessions->Next()) {
        const auto session = session_of(sessions->key().ToStringView());
        if (!session) break;
        if (*session >= ends.next_session) {
            return failure("the store {} cannot be opened: its count of sessions is damaged; {}", directory.native(),
                           kRecover);
        }
        const auto end = end_of_log(database, directory.native(), *session); // damage of one does not affect the others
        ends.revisions.emplace(*session, end ? *end : 0);
        if (!end) ends.damaged.emplace(*session, end.error());
    }
    if (!sessions->status().ok()) return cannot_open(directory, sessions->status());
    return ends;
}

rocksdb::Options options_to_read(const StoreOptions& options, bool has_unfinished_write) {
    auto rocksdb = rocksdb_options(options, std::make_shared<CompactionWatch>());
    rocksdb.create_if_missing = false;
    // Everything before an unfinished write is known to be intact, so reading just ends there, as after
    // cut_off_unfinished_write().
    if (has_unfinished_write) rocksdb.wal_recovery_mode = rocksdb::WALRecoveryMode::kPointInTimeRecovery;
    return rocksdb;
}

} // namespace

Result<Revision> end_of_log(rocksdb::DB& database, const std::string& store, SessionId session) {
    const auto unknown = [&](std::string_view what, std::string_view advice = kRecoverOrRemove) {
        return Error{Errc::kDataLoss, fmt::format("the store {} cannot find where the log of session {} ends ({}); {}",
                                                  store, session, what, advice)};
    };
    const KeyRange range = entries_of(session);
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    iterator->SeekForPrev(range.end);
    if (const auto& status = iterator->status(); !status.ok()) {
        if (code_of(status) == Errc::kDataLoss) return unknown(status.ToString());
        return unknown(status.ToString(), "if its disk works again, restart the server");
    }
    if (!iterator->Valid() || iterator->key().compare(range.begin) < 0) return Revision{0};
    const auto revision = revision_of(iterator->key().ToStringView());
    if (!revision) return unknown("the key of the last entry");
    return *revision;
}

Result<std::unique_ptr<Database>> Database::open(const fs::path& directory, LockedDirectory::Files files,
                                                 const StoreOptions& options) {
    auto locked = LockedDirectory::open(directory, files);
    if (!locked) return locked.error();
    const auto torn_bytes = cut_off_unfinished_write(*locked);
    if (!torn_bytes) return torn_bytes.error();

    const auto watch = std::make_shared<CompactionWatch>();
    rocksdb::DB* opened = nullptr;
    const auto status = rocksdb::DB::Open(rocksdb_options(options, watch), directory.native(), &opened);
    std::unique_ptr<rocksdb::DB> database(opened);
    if (!status.ok()) return cannot_open(directory, status);
    if (auto written = write_format_if_needed(*database, directory); !written) return written.error();
    if (auto finished = locked->finish_creation(); !finished) return finished.error();
    auto files_watch = std::make_unique<FilesWatch>(*database, directory);
    return read_ends({std::move(*locked), std::move(database), *torn_bytes, watch, std::move(files_watch)}, options);
}

Result<std::unique_ptr<Database>> Database::open_read_only(const fs::path& directory, const StoreOptions& options) {
    auto locked = LockedDirectory::open_to_read(directory);
    if (!locked) return locked.error();
    std::error_code problem;
    if (!fs::exists(directory / "CURRENT", problem)) {
        return Error{Errc::kNotFound, fmt::format("the directory {} holds no store", directory.native())};
    }
    const auto unfinished = find_unfinished_write(*locked);
    if (!unfinished) return unfinished.error();

    rocksdb::DB* opened = nullptr;
    const auto status =
        rocksdb::DB::OpenForReadOnly(options_to_read(options, unfinished->has_value()), directory.native(), &opened);
    std::unique_ptr<rocksdb::DB> database(opened);
    if (!status.ok()) return cannot_open(directory, status);
    if (const auto format = must_write_format(*database, directory); !format) return format.error();
    return read_ends({std::move(*locked), std::move(database), *unfinished ? (*unfinished)->bytes : 0,
                      std::make_shared<CompactionWatch>()},
                     options);
}

/// Completes the opening of a database.
Result<std::unique_ptr<Database>> Database::read_ends(Opened opened, const StoreOptions& options) {
    auto ends = store::read_ends(*opened.database, opened.directory.path());
    if (!ends) return ends.error();
    return std::unique_ptr<Database>(new Database(std::move(opened), std::move(*ends), options));
}

bool Database::can_be_opened(const fs::path& directory, const StoreOptions& options) {
    rocksdb::Env* const env = options.env != nullptr ? options.env : rocksdb::Env::Default();
    std::uint64_t needed = 1 << 20;
    for (const auto& log : regular_files(directory, ".log")) {
        std::error_code gone;
        const auto size = fs::file_size(log, gone);
        if (!gone) needed += size;
    }
    std::uint64_t free = 0;
    if (!env->GetFreeSpace(directory.native(), &free).ok() || free < needed) return false;
    const auto probe = (directory / "probe.dbtmp").native(); // LockedDirectory ignores this extension
    const bool written = rocksdb::WriteStringToFile(env, std::string(4096, 'p'), probe, true).ok();
    env->DeleteFile(probe).PermitUncheckedError();
    return written;
}

Database::Database(Opened opened, LogEnds ends, const StoreOptions& options)
    : opened_(std::move(opened)), ends_(std::move(ends)), compactions_(rocksdb(), options.disk_reserve_bytes),
      on_damage_(options.on_damage),
      committer_(rocksdb(), name(), options.disk_reserve_bytes, compactions_, opened_.files.get()) {
    opened_.watch->set_report([this](const rocksdb::Status& reason) { continue_without_compaction(reason); });
}

Database::~Database() { opened_.watch->set_report(nullptr); }

/// Stops compactions, which RocksDB would otherwise retry every second without end.
void Database::continue_without_compaction(const rocksdb::Status& reason) {
    Error damage{Errc::kDataLoss,
                 fmt::format("the store {} is damaged: {}; new entries are stored completely, but its files are no "
                             "longer merged and use more disk; when you can, {}",
                             name(), reason.ToString(), kRecover)};
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

void Database::free_disk(SessionId session) {
    if (!committer_.stats().no_room) rocksdb().Flush({}).PermitUncheckedError();
    for (const KeyRange& range : {entries_of(session), parts_of(session)}) {
        const rocksdb::Slice begin(range.begin);
        const rocksdb::Slice end(range.end);
        rocksdb::DeleteFilesInRange(&rocksdb(), rocksdb().DefaultColumnFamily(), &begin, &end, false)
            .PermitUncheckedError();
    }
}

std::vector<SessionId> Database::owners_without_record() {
    std::set<SessionId> found;
    const std::unique_ptr<rocksdb::Iterator> iterator(rocksdb().NewIterator({}));
    for (const auto range_of : {&parts_of, &entries_of}) {
        for (iterator->Seek(range_of(0).begin); iterator->Valid();) {
            const std::string key = iterator->key().ToString();
            const auto owner = owner_of(key);
            if (!owner || !key.starts_with(range_of(0).begin.front())) break;
            if (!ends_.revisions.contains(*owner)) found.insert(*owner);
            iterator->Seek(range_of(*owner).end);
        }
    }
    return {found.begin(), found.end()};
}

StoreStats Database::stats() const {
    StoreStats stats = committer_.stats();
    stats.torn_bytes_dropped = opened_.torn_bytes;
    const std::lock_guard lock(damage_mutex_);
    if (damage_) stats.damage = damage_->message;
    return stats;
}

} // namespace scanloom::store
