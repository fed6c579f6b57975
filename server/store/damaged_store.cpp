#include "server/store/damaged_store.hpp"

#include "server/store/block_scan.hpp"
#include "server/store/crash_recovery.hpp"
#include "server/store/files.hpp"
#include "server/store/log_file.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/env.h>
#include <rocksdb/sst_file_reader.h>
#include <rocksdb/write_batch.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTable = ".sst";
constexpr std::string_view kLog = ".log";
constexpr std::size_t kBatchHeaderBytes = 12;
constexpr std::size_t kPieceBytes = std::size_t{4} << 10; // a page, and the smallest unit that most disks lose

rocksdb::Env& env_of(const StoreOptions& options) {
    return options.env != nullptr ? *options.env : *rocksdb::Env::Default();
}

/// Options that accept damaged and missing files, and damage in the write-ahead logs.
rocksdb::Options options_of_catalog(const StoreOptions& options) {
    auto rocksdb = rocksdb_options(options, std::make_shared<CompactionWatch>());
    rocksdb.create_if_missing = false;
    rocksdb.paranoid_checks = false;
    rocksdb.skip_checking_sst_file_sizes_on_db_open = true;
    rocksdb.track_and_verify_wals_in_manifest = false;
    rocksdb.wal_recovery_mode = rocksdb::WALRecoveryMode::kSkipAnyCorruptedRecords;
    return rocksdb;
}

/// Collects the records, the entries and the removed sessions of the writes in a write-ahead log.
class LogContents : public rocksdb::WriteBatch::Handler {
public:
    LogContents(std::map<std::string, std::string>& values, std::set<SessionId>& removed)
        : values_(values), removed_(removed) {}

    rocksdb::Status PutCF(std::uint32_t, const rocksdb::Slice& key, const rocksdb::Slice& value) override {
        const auto view = key.ToStringView();
        if (session_of(view) || revision_of(view)) values_.insert_or_assign(key.ToString(), value.ToString());
        return {};
    }
    rocksdb::Status DeleteCF(std::uint32_t, const rocksdb::Slice& key) override {
        if (const auto session = session_of(key.ToStringView())) removed_.insert(*session);
        return {};
    }
    rocksdb::Status DeleteRangeCF(std::uint32_t, const rocksdb::Slice&, const rocksdb::Slice&) override { return {}; }

private:
    std::map<std::string, std::string>& values_;
    std::set<SessionId>& removed_;
};

} // namespace

Result<std::unique_ptr<DamagedStore>> DamagedStore::open(const fs::path& store, const StoreOptions& options) {
    auto locked = LockedDirectory::open_to_read(store, LockedDirectory::Files::kDamaged);
    if (!locked) return locked.error();
    if (regular_files(store, kTable).empty() && regular_files(store, kLog).empty()) {
        return Error{Errc::kNotFound,
                     fmt::format("there is no store in {}: it has neither tables nor write-ahead logs; "
                                 "name its directory, or mount its disk",
                                 store.native())};
    }
    std::unique_ptr<DamagedStore> opened(new DamagedStore(*std::move(locked), options));
    if (auto files = opened->open_files(); !files) return files.error();
    opened->open_tables();
    opened->open_catalog();
    if (auto logs = opened->read_write_ahead_logs(); !logs) return logs.error();
    opened->find_sessions();
    return opened;
}

struct DamagedStore::Rocksdb {
    rocksdb::Options table_options;       // for reading one table by itself
    std::unique_ptr<rocksdb::DB> catalog; // which sessions exist; null: the manifest does not name every table
};

DamagedStore::DamagedStore(LockedDirectory directory, const StoreOptions& options)
    : directory_(std::move(directory)), options_(options), rocksdb_(new Rocksdb{options_of_table(options), nullptr}) {}

DamagedStore::~DamagedStore() = default;

/// Checks that every file can be opened.
Result<> DamagedStore::open_files() const {
    for (const auto& path : regular_files(directory_.path())) {
        std::unique_ptr<rocksdb::RandomAccessFile> file;
        const auto status = env_of(options_).NewRandomAccessFile(path.native(), &file, {});
        if (!status.ok()) {
            return failure("cannot read {}: {}; check its permissions, or copy the store to another disk and repair "
                           "the copy",
                           path.native(), status.ToString());
        }
    }
    return {};
}

void DamagedStore::open_tables() {
    for (const auto& file : regular_files(directory_.path(), kTable)) {
        rocksdb::SstFileReader reader(rocksdb_->table_options);
        if (const auto status = reader.Open(file.native()); !status.ok()) {
            note_damage(file,
                        fmt::format("its index cannot be read, and all its entries are lost ({})", status.ToString()));
            continue;
        }
        if (const auto status = reader.VerifyChecksum(); !status.ok()) {
            note_damage(file, fmt::format("the entries in its readable blocks are kept ({})", status.ToString()));
        }
        const std::unique_ptr<rocksdb::Iterator> keys(reader.NewIterator({}));
        keys->SeekToFirst();
        std::string smallest = keys->Valid() ? keys->key().ToString() : "";
        keys->SeekToLast();
        tables_.push_back({file, std::move(smallest), keys->Valid() ? keys->key().ToString() : "\xff"});
    }
}

/// Opens the database to look up which sessions exist. It must know every table: otherwise a session that it does not
/// know may be in one of the others.
void DamagedStore::open_catalog() {
    const auto& store = directory_.path();
    if (const auto manifest = check_manifest(store); !manifest)
        return note_damage("MANIFEST", manifest.error().message);
    rocksdb::DB* opened = nullptr;
    const auto status = rocksdb::DB::OpenForReadOnly(options_of_catalog(options_), store.native(), &opened);
    rocksdb_->catalog.reset(opened);
    if (!status.ok()) {
        return note_damage(fs::exists(store / "CURRENT") ? "MANIFEST" : "CURRENT",
                           fmt::format("RocksDB cannot open the store ({})", status.ToString()));
    }
    std::vector<rocksdb::LiveFileMetaData> live;
    rocksdb_->catalog->GetLiveFilesMetaData(&live);
    std::set<std::string> named;
    for (const auto& table : live) {
        named.insert(table.relative_filename);
        if (!fs::exists(store / table.relative_filename)) {
            note_damage(table.relative_filename, "it is missing, and all its entries are lost");
        }
    }
    for (const auto& table : regular_files(store, kTable)) {
        if (named.contains(table.filename().native())) continue;
        note_damage("MANIFEST",
                    fmt::format("it does not name {}; the entries of that table are kept", table.filename().native()));
        rocksdb_->catalog.reset();
    }
}

Result<> DamagedStore::read_write_ahead_logs() {
    const auto logs = regular_files(directory_.path(), kLog);
    if (logs.empty() || !check_newest_log(directory_.path())) {
        note_damage("the newest write-ahead log", "it is missing, and all its entries are lost");
    }
    LogContents contents(logged_, removed_);
    for (const auto& file : logs) {
        const auto bytes = read_file(file);
        if (!bytes) return bytes.error();
        if (const auto damage = check_log_file(*bytes).damage) {
            note_damage(file,
                        fmt::format("at byte {}; the complete writes before and after the damage are kept", *damage));
        }
        for (auto& write : whole_writes_of(*bytes)) {
            if (write.size() < kBatchHeaderBytes) continue;
            // Cannot fail: the checksum of the write is valid.
            rocksdb::WriteBatch(std::move(write)).Iterate(&contents).PermitUncheckedError();
        }
    }
    return {};
}

/// Reads a file. Bytes that the disk cannot read are noted and replaced by zeros, in pieces of 4 KiB.
Result<std::string> DamagedStore::read_file(const fs::path& file) {
    std::uint64_t size = 0;
    std::unique_ptr<rocksdb::RandomAccessFile> in;
    auto status = env_of(options_).GetFileSize(file.native(), &size);
    if (status.ok()) status = env_of(options_).NewRandomAccessFile(file.native(), &in, {});
    if (!status.ok()) return failure("cannot read {}: {}", file.native(), status.ToString());
    std::string bytes(size, '\0');
    std::uint64_t unreadable = 0;
    for (std::uint64_t at = 0; at < size; at += kPieceBytes) {
        char* const to = bytes.data() + at;
        const auto count = std::min<std::size_t>(kPieceBytes, size - at);
        rocksdb::Slice piece;
        if (in->Read(at, count, &piece, to).ok() && piece.size() == count) {
            if (piece.data() != to) std::memcpy(to, piece.data(), count);
        } else {
            std::fill_n(to, count, '\0');
            unreadable += count;
        }
    }
    if (unreadable > 0) note_damage(file, fmt::format("the disk cannot read {} bytes of it", unreadable));
    return bytes;
}

/// Finds the records, and the sessions that have entries but no record.
void DamagedStore::find_sessions() {
    const auto add_record = [this](std::string_view key, std::string_view sealed_value) {
        const auto session = session_of(key);
        if (!session || is_removed(*session)) return;
        auto& found = sessions_[*session];
        if (const auto record = unsealed(key, sealed_value); record && !found) found.emplace(*record);
    };
    const auto add_owner = [this](SessionId session) {
        if (!sessions_.contains(session) && !is_removed(session)) sessions_[session];
    };
    for (const auto& [key, value] : logged_) add_record(key, value);
    for (const auto& [key, value] : logged_) add_owner(*owner_of(key));
    for (const auto& table : tables_) {
        BlockScan records(table.file, {std::string(kSessionsBegin), std::string(kSessionsEnd)},
                          rocksdb_->table_options);
        for (; records.valid(); records.next()) add_record(records.key(), records.sealed_value());
        BlockScan owners(table.file, {std::string(kEntriesBegin), std::string(kEntriesEnd)}, rocksdb_->table_options);
        for (; owners.valid(); owners.seek(owners.number() + 1)) add_owner(owners.number());
    }
}

/// Ids are never reused, and every session has a record until it is removed. The catalog may not have read the newest
/// writes, so it is not asked about sessions that the write-ahead logs name.
bool DamagedStore::is_removed(SessionId session) const {
    if (removed_.contains(session)) return true;
    const auto entry = logged_.lower_bound(entries_of(session).begin);
    const bool is_logged =
        logged_.contains(session_key(session)) || (entry != logged_.end() && entry->first < entries_of(session).end);
    if (!rocksdb_->catalog || is_logged) return false;
    std::string record;
    return rocksdb_->catalog->Get({}, session_key(session), &record).IsNotFound();
}

Result<std::uint64_t> DamagedStore::read(SessionId session, const ScanLog::VisitEntry& visit) const {
    const auto range = entries_of(session);
    std::vector<std::unique_ptr<BlockScan>> scans;
    for (const auto& table : tables_) {
        if (table.largest < range.begin || table.smallest >= range.end) continue;
        auto scan = std::make_unique<BlockScan>(table.file, range, rocksdb_->table_options);
        if (scan->valid()) scans.push_back(std::move(scan));
    }
    auto logged = logged_.lower_bound(range.begin);
    const auto last_logged = logged_.lower_bound(range.end);
    std::uint64_t damaged = 0;
    while (!scans.empty() || logged != last_logged) {
        Revision next = logged != last_logged ? *revision_of(logged->first) : scans.front()->number();
        for (const auto& scan : scans) next = std::min(next, scan->number());
        std::optional<std::string> entry;
        const auto take = [&entry](std::string_view key, std::string_view sealed_value) {
            if (const auto bytes = unsealed(key, sealed_value); bytes && !entry) entry.emplace(*bytes);
        };
        if (logged != last_logged && *revision_of(logged->first) == next) {
            take(logged->first, logged->second);
            ++logged;
        }
        for (const auto& scan : scans) {
            if (scan->number() != next) continue;
            take(scan->key(), scan->sealed_value());
            scan->next();
        }
        std::erase_if(scans, [](const auto& scan) { return !scan->valid(); });
        if (!entry) {
            ++damaged;
        } else if (const auto visited = visit(next, *entry); !visited) {
            return visited.error();
        } else if (*visited == Visit::kStop) {
            break;
        }
    }
    return damaged;
}

void DamagedStore::note_damage(const fs::path& file, std::string_view how) {
    damaged_.insert(file.filename().native());
    notes_.push_back(fmt::format("{} is damaged: {}", file.filename().native(), how));
}

} // namespace scanloom::store
