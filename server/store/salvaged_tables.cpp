#include "server/store/salvaged_tables.hpp"

#include "server/store/compaction.hpp"
#include "server/store/crash_recovery.hpp"
#include "server/store/directory.hpp"
#include "server/store/log_file.hpp"
#include "server/store/readable_file.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/store_error.hpp"
#include "server/store/table_carving.hpp"
#include "server/store/table_check.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>
#include <rocksdb/write_batch.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTable = ".sst";
constexpr std::string_view kLog = ".log";
constexpr std::string_view kSetAside = "aside"; // holds tables that RocksDB does not know
constexpr std::size_t kBatchHeaderBytes = 12;

/// Options for a copy that only this object uses: they accept what is there.
rocksdb::Options options_of_copy(const StoreOptions& options) {
    auto rocksdb = rocksdb_options(options, std::make_shared<CompactionWatch>());
    rocksdb.create_if_missing = false;
    rocksdb.track_and_verify_wals_in_manifest = false; // the logs are not copied
    rocksdb.disable_auto_compactions = true;           // a bad block would stop them
    return rocksdb;
}

rocksdb::Env& env_of(const StoreOptions& options) {
    return options.env != nullptr ? *options.env : *rocksdb::Env::Default();
}

bool tells_of_tables(const fs::path& name) {
    return name == "CURRENT" || name == "IDENTITY" || name.native().starts_with("MANIFEST-") ||
           name.native().starts_with("OPTIONS-");
}

/// Returns RocksDB's message without the paths of the copy, which no longer exists when the message is read.
std::string reason_of(const rocksdb::Status& status, const fs::path& copy) {
    auto text = status.ToString();
    for (auto at = text.find(copy.native()); at != std::string::npos; at = text.find(copy.native())) {
        text.erase(at, copy.native().size() + 1);
    }
    std::ranges::replace(text, '\n', ' ');
    return text;
}

/// Returns the first table that RocksDB did not find. RocksDB may report it with another extension.
std::optional<std::string> missing_table_in(const std::string& reason) {
    constexpr std::string_view kDigits = "0123456789";
    constexpr std::size_t kDigitsMin = 6;
    for (auto dot = reason.find('.'); dot != std::string::npos; dot = reason.find('.', dot + 1)) {
        const auto ending = std::string_view(reason).substr(dot, kTable.size());
        if (ending != kTable && ending != ".ldb") continue;
        const auto before = std::string_view(reason).substr(0, dot);
        const auto digits = before.substr(before.find_last_not_of(kDigits) + 1); // npos + 1 is 0
        if (digits.size() >= kDigitsMin) return std::string(digits) + std::string(kTable);
    }
    return std::nullopt;
}

/// Collects the sessions that a write removes.
class Removals : public rocksdb::WriteBatch::Handler {
public:
    explicit Removals(std::set<SessionId>& sessions) : sessions_(sessions) {}

    rocksdb::Status PutCF(std::uint32_t, const rocksdb::Slice&, const rocksdb::Slice&) override { return {}; }
    rocksdb::Status DeleteCF(std::uint32_t, const rocksdb::Slice& key) override {
        if (const auto session = session_of(key.ToStringView())) sessions_.insert(*session);
        return {};
    }
    rocksdb::Status DeleteRangeCF(std::uint32_t, const rocksdb::Slice&, const rocksdb::Slice&) override { return {}; }

private:
    std::set<SessionId>& sessions_;
};

} // namespace

Result<std::unique_ptr<SalvagedTables>> SalvagedTables::open(const fs::path& store, const fs::path& copy,
                                                             const StoreOptions& options) {
    std::unique_ptr<SalvagedTables> tables(new SalvagedTables(store, copy, options));
    for (const auto step : {&SalvagedTables::copy_files, &SalvagedTables::open_database, &SalvagedTables::take_damaged,
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

/// Copies all files except the write-ahead logs, which are read in place. Tables are hard-linked where the disk allows
/// it.
Result<> SalvagedTables::copy_files() {
    std::error_code problem;
    if (!fs::create_directories(copy_, problem)) {
        return failure("cannot make the directory {}: {}", copy_.native(),
                       problem ? problem.message() : "it exists; remove it first");
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
    auto rocksdb = options_of_copy(options_);
    rocksdb::DB* opened = nullptr;
    auto status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    has_all_ = status.ok();
    if (!status.ok()) {
        note_why_not(reason_of(status, copy_));
        if (auto aside = set_all_aside(); !aside) return aside;
        rocksdb.create_if_missing = true;
        status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    }
    database_.reset(opened);
    if (!status.ok()) return failure("nothing of it can be read: {}", reason_of(status, copy_));
    return has_all_ ? set_unlisted_aside() : Result<>();
}

/// Without a manifest, merged tables cannot be distinguished from tables that are not merged yet, so RocksDB must not
/// open them together.
Result<> SalvagedTables::set_all_aside() {
    std::error_code problem;
    fs::create_directories(copy_ / kSetAside, problem);
    for (const auto& file : regular_files(copy_)) {
        if (problem) break;
        if (file.extension() == kTable)
            fs::rename(file, copy_ / kSetAside / file.filename(), problem);
        else
            fs::remove(file, problem);
    }
    if (problem) return failure("cannot write {}: {}", copy_.native(), problem.message());
    return {};
}

/// RocksDB does not open a store whose manifest or tables are missing or changed.
void SalvagedTables::note_why_not(const std::string& reason) {
    notes_.push_back(fmt::format("RocksDB cannot open it as it is ({}); each of its tables is read by itself", reason));
    if (!fs::exists(store_ / "CURRENT")) is_damaged("CURRENT", "it is missing");
    if (const auto manifest = check_manifest(store_); !manifest) is_damaged("MANIFEST", manifest.error().message);
    const auto missing = missing_table_in(reason);
    if (missing && !fs::exists(store_ / *missing)) {
        is_damaged(*missing, "it is missing, and maybe others: what they had is lost, how much cannot be told");
    }
}

/// A manifest that ends early names only the first tables, and RocksDB removes the others.
Result<> SalvagedTables::set_unlisted_aside() {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : regular_files(store_, kTable)) {
        const auto name = table.filename();
        if (std::ranges::any_of(live, [&](const auto& one) { return one.relative_filename == name; })) continue;
        has_all_ = false;
        is_damaged("MANIFEST", fmt::format("{} is not in this list of tables; what it has was taken", name.native()));
        std::error_code problem;
        fs::create_directories(copy_ / kSetAside, problem);
        if (auto copied = copy(table, copy_ / kSetAside / name); !copied) return copied;
    }
    return {};
}

std::vector<fs::path> SalvagedTables::files() const {
    auto tables = regular_files(copy_, kTable);
    std::ranges::copy(regular_files(copy_ / kSetAside, kTable), std::back_inserter(tables));
    return tables;
}

/// Runs before the write-ahead logs are taken, because their writes are later ones.
Result<> SalvagedTables::take_damaged() {
    std::vector<fs::path> damaged;
    for (const auto& table : files()) {
        if (!check_table(table, options_)) {
            damaged.push_back(table);
        } else if (!has_all_) {
            const auto bytes = read(table);
            if (!bytes) return bytes.error();
            removed_.merge(sessions_removed_in(*bytes));
        }
    }
    for (const auto& table : damaged) {
        const auto taken = carve(table);
        if (!taken) return taken.error();
        is_damaged(table, fmt::format("what is intact of it was taken, {} entries", *taken));
    }
    if (!has_all_ && damaged_.empty()) is_damaged("MANIFEST", "it does not fit the tables that are there");
    return {};
}

void SalvagedTables::is_damaged(const fs::path& file, std::string_view how) {
    damaged_.insert(file.filename().native());
    notes_.push_back(fmt::format("{} is damaged: {}", file.filename().native(), how));
}

/// Unreadable bytes are noted and replaced by zeros.
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

/// @return number of entries taken
Result<std::uint64_t> SalvagedTables::carve(const fs::path& table) {
    rocksdb::WriteBatch batch;
    std::uint64_t taken = 0;
    const auto file = read(table);
    if (!file) return file.error();
    carve_table(*file, [&](std::string_view key, std::string_view sealed_value) {
        if (is_removed(*owner_of(key))) return;
        if (std::string newer; session_of(key) && database_->Get({}, key, &newer).ok() && unsealed(key, newer)) return;
        batch.Put(key, sealed_value).PermitUncheckedError(); // fails only for a limited batch, which this is not
        if (!session_of(key)) ++taken;
    });
    if (const auto status = database_->Write({}, &batch); !status.ok()) {
        return failure("what is left of {} cannot be taken: {}", table.native(), status.ToString());
    }
    return taken;
}

/// A write that is also in a table is applied again without effect.
Result<> SalvagedTables::take_write_ahead_logs() {
    const auto newest = check_newest_log(store_);
    if (!newest || regular_files(store_, kLog).empty()) {
        is_damaged("the newest write-ahead log", "it is missing: what it had is lost, how much cannot be told");
    }
    for (const auto& file : regular_files(store_, kLog)) {
        const auto bytes = read(file);
        if (!bytes) return bytes.error();
        if (const auto damage = check_log_file(*bytes).damage) {
            is_damaged(file, fmt::format("from byte {} on; its whole writes are taken, before it and behind", *damage));
        }
        for (auto& write : whole_writes_of(*bytes)) {
            if (write.size() < kBatchHeaderBytes) continue;
            rocksdb::WriteBatch batch(std::move(write));
            Removals removals(removed_);
            batch.Iterate(&removals).PermitUncheckedError(); // cannot fail: the checksum of the write is valid
            if (const auto status = database_->Write({}, &batch); !status.ok()) {
                return failure("a write of {} cannot be taken: {}", file.filename().native(), status.ToString());
            }
        }
    }
    if (const auto status = database_->Flush({}); !status.ok()) {
        return failure("cannot write {}: {}", copy_.native(), status.ToString());
    }
    return {};
}

void SalvagedTables::list() {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : live) {
        all_.push_back({copy_ / table.relative_filename, table.smallestkey, table.largestkey});
    }
    const auto last = std::string(1, '\xff'); // greater than every key
    for (const auto& table : regular_files(copy_ / kSetAside, kTable)) all_.push_back({table, "", last});
}

bool SalvagedTables::is_removed(SessionId session) const {
    if (!has_all_) return removed_.contains(session); // ids are never reused
    std::string record;
    // Every session has a record until it is removed.
    return database_->Get({}, session_key(session), &record).IsNotFound();
}

} // namespace scanloom::store
