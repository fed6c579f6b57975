#include "server/store/salvaged_tables.hpp"

#include "server/store/compaction_watch.hpp"
#include "server/store/crash_recovery.hpp"
#include "server/store/listing.hpp"
#include "server/store/log_file.hpp"
#include "server/store/readable_file.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/table_carving.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>
#include <rocksdb/sst_file_reader.h>
#include <rocksdb/write_batch.h>

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTable = ".sst";
constexpr std::string_view kLog = ".log";
constexpr std::string_view kSetAside = "lost"; // where RepairDB puts tables of which it could not read all
constexpr std::size_t kBatchHeaderBytes = 12;

Error failure(std::string message) { return {Errc::kStoreFailed, std::move(message)}; }

/// For a copy that nothing else uses: takes what there is.
rocksdb::Options options_of_copy(const StoreOptions& options) {
    auto rocksdb = rocksdb_options(options, std::make_shared<CompactionWatch>());
    rocksdb.create_if_missing = false;
    rocksdb.track_and_verify_wals_in_manifest = false; // the logs are not copied
    rocksdb.disable_auto_compactions = true;           // which a bad block would stop
    return rocksdb;
}

rocksdb::Env& env_of(const StoreOptions& options) {
    return options.env != nullptr ? *options.env : *rocksdb::Env::Default();
}

bool tells_of_tables(const fs::path& name) {
    return name == "CURRENT" || name == "IDENTITY" || name.native().starts_with("MANIFEST-") ||
           name.native().starts_with("OPTIONS-");
}

/// Without the places of the copy, which is gone when somebody reads this.
std::string reason_of(const rocksdb::Status& status, const fs::path& copy) {
    auto text = status.ToString();
    for (auto at = text.find(copy.native()); at != std::string::npos; at = text.find(copy.native())) {
        text.erase(at, copy.native().size() + 1);
    }
    std::ranges::replace(text, '\n', ' ');
    return text;
}

} // namespace

Result<std::unique_ptr<SalvagedTables>> SalvagedTables::open(const fs::path& store, const fs::path& copy,
                                                             const StoreOptions& options) {
    std::unique_ptr<SalvagedTables> tables(new SalvagedTables(store, copy, options));
    for (const auto step : {&SalvagedTables::copy_files, &SalvagedTables::open_database, &SalvagedTables::carve_damaged,
                            &SalvagedTables::take_write_ahead_logs}) {
        if (auto done = (*tables.*step)(); !done) return done.error();
    }
    tables->list();
    return tables;
}

SalvagedTables::SalvagedTables(fs::path store, fs::path copy, const StoreOptions& options)
    : store_(std::move(store)), copy_(std::move(copy)), options_(options) {}

SalvagedTables::~SalvagedTables() {
    database_.reset();
    std::error_code ignored;
    fs::remove_all(copy_, ignored);
}

/// All but the write-ahead logs, which are read where they are. A table is shared where the disk allows it.
Result<> SalvagedTables::copy_files() {
    std::error_code problem;
    if (!fs::create_directories(copy_, problem)) {
        return failure(fmt::format("cannot make the directory {}: {}", copy_.native(),
                                   problem ? problem.message() : "it exists; remove it first"));
    }
    for (const auto& file : regular_files(store_)) {
        const auto name = file.filename();
        const bool is_table = name.extension() == kTable;
        if (!is_table && !tells_of_tables(name)) continue;
        if (is_table) fs::create_hard_link(file, copy_ / name, problem);
        if (is_table && !problem) continue;
        if (auto copied = copy(file, copy_ / name); !copied) return copied;
    }
    return {};
}

Result<> SalvagedTables::open_database() {
    const auto rocksdb = options_of_copy(options_);
    rocksdb::DB* opened = nullptr;
    auto status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    has_all_ = status.ok();
    if (!status.ok()) {
        if (!check_manifest(store_)) damaged_.insert("MANIFEST");
        notes_.push_back(
            fmt::format("RocksDB cannot open it as it is ({}); its tables were listed anew", reason_of(status, copy_)));
        status = rocksdb::RepairDB(copy_.native(), rocksdb);
        if (status.ok()) status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    }
    database_.reset(opened);
    if (!status.ok()) return failure(fmt::format("nothing of it can be read: {}", reason_of(status, copy_)));
    return has_all_ ? set_unlisted_aside() : Result<>();
}

/// A manifest that ends early names only the first of the tables, and RocksDB removes the others.
Result<> SalvagedTables::set_unlisted_aside() {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : regular_files(store_, kTable)) {
        const auto name = table.filename();
        if (std::ranges::any_of(live, [&](const auto& one) { return one.relative_filename == name; })) continue;
        has_all_ = false;
        notes_.push_back(fmt::format("{} is not in the list of its tables; what it has was taken", name.native()));
        std::error_code problem;
        fs::create_directories(copy_ / kSetAside, problem);
        if (auto copied = copy(table, copy_ / kSetAside / name); !copied) return copied;
    }
    return {};
}

/// Before the write-ahead logs: what these have was written later.
Result<> SalvagedTables::carve_damaged() {
    auto tables = regular_files(copy_, kTable);
    std::ranges::copy(regular_files(copy_ / kSetAside, kTable), std::back_inserter(tables));
    for (const auto& table : tables) {
        if (is_whole(table)) continue;
        const auto taken = carve(table);
        if (!taken) return taken.error();
        is_damaged(table, fmt::format("what is intact of it was taken, {} entries", *taken));
    }
    return {};
}

bool SalvagedTables::is_whole(const fs::path& table) const {
    rocksdb::SstFileReader reader(options_of_table(options_));
    return reader.Open(table.native()).ok() && reader.VerifyChecksum().ok();
}

void SalvagedTables::is_damaged(const fs::path& file, std::string_view how) {
    damaged_.insert(file.filename().native());
    notes_.push_back(fmt::format("{} is damaged: {}", file.filename().native(), how));
}

/// What the disk cannot read is told, and zeros.
Result<std::string> SalvagedTables::read(const fs::path& file) {
    auto read = read_readable(file, env_of(options_));
    if (!read) return read.error();
    if (read->unreadable > 0) is_damaged(file, fmt::format("the disk cannot read {} bytes of it", read->unreadable));
    return std::move(read->bytes);
}

Result<> SalvagedTables::copy(const fs::path& file, const fs::path& to) {
    auto copied = copy_readable(file, to, env_of(options_));
    if (!copied) return copied.error();
    if (*copied > 0) is_damaged(file, fmt::format("the disk cannot read {} bytes of it", *copied));
    return {};
}

/// @return how many entries were taken.
Result<std::uint64_t> SalvagedTables::carve(const fs::path& table) {
    std::map<SessionId, bool> removed;
    rocksdb::WriteBatch batch;
    std::uint64_t taken = 0;
    const auto file = read(table);
    if (!file) return file.error();
    carve_table(*file, [&](std::string_view key, std::string_view sealed_value) {
        const auto session = *owner_of(key);
        const auto [of_session, is_first] = removed.try_emplace(session);
        if (is_first) of_session->second = is_removed(session, table);
        if (of_session->second) return;
        if (std::string newer; session_of(key) && database_->Get({}, key, &newer).ok() && unsealed(key, newer)) return;
        batch.Put(key, sealed_value).PermitUncheckedError(); // fails where a batch is limited, which this is not
        if (!session_of(key)) ++taken;
    });
    if (const auto status = database_->Write({}, &batch); !status.ok()) {
        return failure(fmt::format("what is left of {} cannot be taken: {}", table.native(), status.ToString()));
    }
    return taken;
}

/// A write that is in a table, too, is the same once more.
Result<> SalvagedTables::take_write_ahead_logs() {
    for (const auto& file : regular_files(store_, kLog)) {
        const auto bytes = read(file);
        if (!bytes) return bytes.error();
        if (const auto damage = check_log_file(*bytes).damage) {
            is_damaged(file, fmt::format("from byte {} on; its whole writes are taken, before it and behind", *damage));
        }
        for (auto& write : whole_writes_of(*bytes)) {
            if (write.size() < kBatchHeaderBytes) continue;
            rocksdb::WriteBatch batch(std::move(write));
            if (const auto status = database_->Write({}, &batch); !status.ok()) {
                return failure(
                    fmt::format("a write of {} cannot be taken: {}", file.filename().native(), status.ToString()));
            }
        }
    }
    if (const auto status = database_->Flush({}); !status.ok()) {
        return failure(fmt::format("cannot write {}: {}", copy_.native(), status.ToString()));
    }
    return {};
}

void SalvagedTables::list() {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : live) {
        all_.push_back({copy_ / table.relative_filename, table.smallestkey, table.largestkey});
    }
    const auto last = std::string(1, '\xff'); // behind every key
    for (const auto& table : regular_files(copy_ / kSetAside, kTable)) all_.push_back({table, "", last});
}

/// Whether the database knows that all of it is gone; a table alone does not.
bool SalvagedTables::is_removed(SessionId session, const fs::path& table) const {
    if (table.parent_path() != copy_) return false; // set aside: the database does not have it
    std::string record;
    if (!database_->Get({}, session_key(session), &record).IsNotFound()) return false;
    if (has_all_) return true; // a session has a record until it is removed
    const auto range = entries_of(session);
    const rocksdb::Slice end(range.end);
    rocksdb::ReadOptions read;
    read.iterate_upper_bound = &end; // what lies behind may be damaged, and is none of its entries
    const std::unique_ptr<rocksdb::Iterator> iterator(database_->NewIterator(read));
    iterator->Seek(range.begin);
    return !iterator->Valid() && iterator->status().ok();
}

} // namespace scanloom::store
