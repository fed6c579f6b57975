#include "server/store/salvage.hpp"

#include "server/store/compaction_watch.hpp"
#include "server/store/directory.hpp"
#include "server/store/log_file.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/table_carving.hpp"
#include "server/store/table_walk.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>
#include <rocksdb/write_batch.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

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

std::vector<fs::path> files_with(const fs::path& directory, std::string_view extension) {
    std::vector<fs::path> found;
    std::error_code none;
    for (fs::directory_iterator file(directory, none); !none && file != fs::directory_iterator();
         file.increment(none)) {
        if (file->path().extension() == extension && file->is_regular_file(none)) found.push_back(file->path());
    }
    std::ranges::sort(found);
    return found;
}

/// A file that cannot be read is not one without anything in it: what it has would be lost without a word.
Result<std::string> bytes_in_file(const fs::path& file) {
    std::error_code problem;
    std::string bytes(fs::file_size(file, problem), '\0');
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (problem || !in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
        const auto reason = problem ? problem : std::error_code(errno, std::generic_category());
        return failure(
            fmt::format("cannot read {}: {}; copy the store with a tool that passes over what cannot be read, "
                        "and repair the copy",
                        file.native(), reason.message()));
    }
    return bytes;
}

std::unique_ptr<rocksdb::Iterator> iterator_of(rocksdb::SstFileReader& table) {
    rocksdb::ReadOptions read;
    read.fill_cache = false;
    return std::unique_ptr<rocksdb::Iterator>(table.NewIterator(read));
}

bool is_whole(const fs::path& table) {
    rocksdb::SstFileReader reader{rocksdb::Options()};
    return reader.Open(table.native()).ok() && reader.VerifyChecksum().ok();
}

} // namespace

Result<std::unique_ptr<Salvage>> Salvage::open(const fs::path& store, const fs::path& copy,
                                               const StoreOptions& options) {
    const auto locked = LockedDirectory::open_to_read(store, LockedDirectory::Files::kAny);
    if (!locked) return locked.error();
    std::unique_ptr<Salvage> salvage(new Salvage(copy));
    if (files_with(store, ".sst").empty() && files_with(store, ".log").empty()) {
        return Error{Errc::kNotFound,
                     fmt::format("there is no store in {}: it has neither tables nor write-ahead logs; "
                                 "name its directory, or mount its disk",
                                 store.native())};
    }
    if (auto copied = salvage->copy_files(store); !copied) return copied.error();
    if (auto opened = salvage->open_tables(store, options); !opened) return opened.error();
    if (auto carved = salvage->carve_damaged_tables(); !carved) return carved.error();
    if (auto taken = salvage->take_write_ahead_logs(store); !taken) return taken.error();
    salvage->list_tables();
    salvage->find_sessions();
    return salvage;
}

Salvage::Salvage(fs::path copy) : copy_(std::move(copy)) {}

Salvage::~Salvage() {
    database_.reset();
    std::error_code ignored;
    fs::remove_all(copy_, ignored);
}

/// All but the write-ahead logs, which are read where they are.
Result<> Salvage::copy_files(const fs::path& store) {
    std::error_code problem;
    if (!fs::create_directories(copy_, problem)) {
        return failure(fmt::format("cannot make the directory {}: {}", copy_.native(),
                                   problem ? problem.message() : "it exists; remove it first"));
    }
    for (const auto& file : fs::directory_iterator(store)) {
        const auto name = file.path().filename();
        const auto to = copy_ / name;
        const bool is_table = name.extension() == ".sst";
        const bool tells = name == "CURRENT" || name == "IDENTITY" || name.native().starts_with("MANIFEST-") ||
                           name.native().starts_with("OPTIONS-");
        if ((!is_table && !tells) || !file.is_regular_file(problem)) continue;
        if (is_table) fs::create_hard_link(file.path(), to, problem);
        if (!is_table || problem) fs::copy_file(file.path(), to, problem);
        if (problem) return failure(fmt::format("cannot copy {}: {}", file.path().native(), problem.message()));
    }
    return {};
}

Result<> Salvage::open_tables(const fs::path& store, const StoreOptions& options) {
    const auto rocksdb = options_of_copy(options);
    rocksdb::DB* opened = nullptr;
    auto status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    has_all_tables_ = status.ok();
    if (!status.ok()) {
        notes_.push_back(fmt::format("the list of its tables could not be used ({}) and was made again from the tables",
                                     status.ToString()));
        status = rocksdb::RepairDB(copy_.native(), rocksdb);
        if (status.ok()) status = rocksdb::DB::Open(rocksdb, copy_.native(), &opened);
    }
    database_.reset(opened);
    if (!status.ok()) return failure(fmt::format("nothing of it can be read: {}", status.ToString()));
    return has_all_tables_ ? set_unlisted_aside(store) : Result<>();
}

/// A manifest that ends early names only the first of the tables, and RocksDB removes the others.
Result<> Salvage::set_unlisted_aside(const fs::path& store) {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : files_with(store, ".sst")) {
        const auto name = table.filename();
        if (std::ranges::any_of(live, [&](const auto& one) { return one.relative_filename == name; })) continue;
        has_all_tables_ = false;
        notes_.push_back(fmt::format("{} is not in the list of its tables; what it has was taken", name.native()));
        std::error_code problem;
        fs::create_directories(copy_ / kSetAside, problem);
        fs::copy_file(table, copy_ / kSetAside / name, problem);
        if (problem) return failure(fmt::format("cannot copy {}: {}", table.native(), problem.message()));
    }
    return {};
}

/// Before the write-ahead logs: what these have was written later.
Result<> Salvage::carve_damaged_tables() {
    auto tables = files_with(copy_, ".sst");
    std::ranges::copy(files_with(copy_ / kSetAside, ".sst"), std::back_inserter(tables));
    for (const auto& table : tables) {
        if (is_whole(table)) continue;
        const auto taken = carve(table);
        if (!taken) return taken.error();
        notes_.push_back(fmt::format("{} is damaged; what is intact of it was taken, {} entries",
                                     table.filename().native(), *taken));
    }
    return {};
}

/// @return how many entries were taken.
Result<std::uint64_t> Salvage::carve(const fs::path& table) {
    std::map<SessionId, bool> removed;
    rocksdb::WriteBatch batch;
    std::uint64_t taken = 0;
    const auto bytes = bytes_in_file(table);
    if (!bytes) return bytes.error();
    carve_table(*bytes, [&](std::string_view key, std::string_view sealed_value) {
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
Result<> Salvage::take_write_ahead_logs(const fs::path& store) {
    for (const auto& file : files_with(store, ".log")) {
        const auto bytes = bytes_in_file(file);
        if (!bytes) return bytes.error();
        if (const auto damage = check_log_file(*bytes).damage) {
            notes_.push_back(fmt::format("{} is damaged at byte {}; its whole writes are taken, before it and behind",
                                         file.filename().native(), *damage));
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

void Salvage::list_tables() {
    std::vector<rocksdb::LiveFileMetaData> live;
    database_->GetLiveFilesMetaData(&live);
    for (const auto& table : live) {
        tables_.push_back({copy_ / table.relative_filename, table.smallestkey, table.largestkey});
    }
    const auto last = std::string(1, '\xff'); // behind every key
    for (const auto& table : files_with(copy_ / kSetAside, ".sst")) tables_.push_back({table, "", last});
}

void Salvage::find_sessions() {
    for (const auto& table : tables_) find_records(table);
    for (const auto& table : tables_) find_owners(table);
}

/// Whether the database knows that all of it is gone; a table alone does not.
bool Salvage::is_removed(SessionId session, const fs::path& table) const {
    if (table.parent_path() != copy_) return false; // set aside: the database does not have it
    std::string record;
    if (!database_->Get({}, session_key(session), &record).IsNotFound()) return false;
    if (has_all_tables_) return true; // a session has a record until it is removed
    const auto range = entries_of(session);
    const rocksdb::Slice end(range.end);
    rocksdb::ReadOptions read;
    read.iterate_upper_bound = &end; // what lies behind may be damaged, and is none of its entries
    const std::unique_ptr<rocksdb::Iterator> iterator(database_->NewIterator(read));
    iterator->Seek(range.begin);
    return !iterator->Valid() && iterator->status().ok();
}

void Salvage::find_records(const Table& table) {
    rocksdb::SstFileReader reader{rocksdb::Options()};
    if (!reader.Open(table.file.native()).ok()) return; // carved
    const auto iterator = iterator_of(reader);
    for (iterator->Seek(std::string(kSessionsBegin)); iterator->Valid(); iterator->Next()) {
        const auto key = iterator->key().ToStringView();
        const auto session = session_of(key);
        if (!session) break;
        const auto record = unsealed(key, iterator->value().ToStringView());
        if (is_removed(*session, table.file)) continue;
        auto& found = sessions_[*session];
        if (record && !found) found.emplace(*record);
    }
}

/// Sessions of which there are entries alone.
void Salvage::find_owners(const Table& table) {
    rocksdb::SstFileReader reader{rocksdb::Options()};
    if (!reader.Open(table.file.native()).ok()) return;
    const auto iterator = iterator_of(reader);
    for (iterator->Seek(entries_of(0).begin); iterator->Valid();) {
        const auto key = iterator->key().ToStringView();
        const auto owner = owner_of(key);
        if (!owner || !revision_of(key)) break;
        if (!sessions_.contains(*owner) && !is_removed(*owner, table.file)) sessions_[*owner];
        iterator->Seek(entries_of(*owner).end);
    }
}

Result<std::uint64_t> Salvage::read(SessionId session, const VisitEntry& visit) const {
    const auto range = entries_of(session);
    std::vector<std::unique_ptr<TableWalk>> walks;
    for (const auto& table : tables_) {
        if (table.largest < range.begin || table.smallest >= range.end) continue;
        auto walk = std::make_unique<TableWalk>(table.file, session);
        if (walk->valid()) walks.push_back(std::move(walk));
    }
    std::uint64_t damaged = 0;
    while (!walks.empty()) {
        Revision next = walks.front()->revision();
        for (const auto& walk : walks) next = std::min(next, walk->revision());
        std::optional<std::string> entry;
        for (const auto& walk : walks) {
            if (walk->revision() != next) continue;
            const auto bytes = unsealed(walk->key(), walk->sealed_value());
            if (bytes && !entry) entry.emplace(*bytes);
            walk->next();
        }
        std::erase_if(walks, [](const auto& walk) { return !walk->valid(); });
        if (!entry) {
            ++damaged;
        } else if (auto visited = visit(next, *entry); !visited) {
            return visited.error();
        }
    }
    return damaged;
}

} // namespace scanloom::store
