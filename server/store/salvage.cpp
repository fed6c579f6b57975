#include "server/store/salvage.hpp"

#include "server/store/directory.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/table_walk.hpp"

#include <fmt/format.h>
#include <rocksdb/sst_file_reader.h>

#include <algorithm>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<rocksdb::Iterator> iterator_of(rocksdb::SstFileReader& table) {
    rocksdb::ReadOptions read;
    read.fill_cache = false;
    return std::unique_ptr<rocksdb::Iterator>(table.NewIterator(read));
}

} // namespace

Result<std::unique_ptr<Salvage>> Salvage::open(const fs::path& store, const fs::path& copy,
                                               const StoreOptions& options) {
    const auto locked = LockedDirectory::open_to_read(store, LockedDirectory::Files::kDamaged);
    if (!locked) return locked.error();
    if (regular_files(store, ".sst").empty() && regular_files(store, ".log").empty()) {
        return Error{Errc::kNotFound,
                     fmt::format("there is no store in {}: it has neither tables nor write-ahead logs; "
                                 "name its directory, or mount its disk",
                                 store.native())};
    }
    auto tables = SalvagedTables::open(store, copy, options);
    if (!tables) return tables.error();
    std::unique_ptr<Salvage> salvage(new Salvage(*std::move(tables), options));
    salvage->find_sessions();
    return salvage;
}

Salvage::Salvage(std::unique_ptr<SalvagedTables> tables, const StoreOptions& options)
    : tables_(std::move(tables)), options_(options_of_table(options)) {}

void Salvage::find_sessions() {
    for (const auto& table : tables_->all()) find_records(table);
    for (const auto& table : tables_->all()) find_owners(table);
}

void Salvage::find_records(const SalvagedTables::Table& table) {
    rocksdb::SstFileReader reader(options_);
    if (!reader.Open(table.file.native()).ok()) return; // its entries were taken by carve_table()
    const auto iterator = iterator_of(reader);
    for (iterator->Seek(std::string(kSessionsBegin)); iterator->Valid(); iterator->Next()) {
        const auto key = iterator->key().ToStringView();
        const auto session = session_of(key);
        if (!session) break;
        const auto record = unsealed(key, iterator->value().ToStringView());
        if (tables_->is_removed(*session)) continue;
        auto& found = sessions_[*session];
        if (record && !found) found.emplace(*record);
    }
}

/// Adds the sessions that have entries but no record.
void Salvage::find_owners(const SalvagedTables::Table& table) {
    rocksdb::SstFileReader reader(options_);
    if (!reader.Open(table.file.native()).ok()) return;
    const auto iterator = iterator_of(reader);
    for (iterator->Seek(entries_of(0).begin); iterator->Valid();) {
        const auto key = iterator->key().ToStringView();
        const auto owner = owner_of(key);
        if (!owner || !revision_of(key)) break;
        if (!sessions_.contains(*owner) && !tables_->is_removed(*owner)) sessions_[*owner];
        iterator->Seek(entries_of(*owner).end);
    }
}

Result<std::uint64_t> Salvage::read(SessionId session, const VisitEntry& visit) const {
    const auto range = entries_of(session);
    std::vector<std::unique_ptr<TableWalk>> walks;
    for (const auto& table : tables_->all()) {
        if (table.largest < range.begin || table.smallest >= range.end) continue;
        auto walk = std::make_unique<TableWalk>(table.file, session, options_);
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
