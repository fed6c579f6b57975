#include "server/store/at_rest.hpp"

#include "server/store/compaction.hpp"
#include "server/store/crash_recovery.hpp"
#include "server/store/directory.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/rocksdb_scan_log.hpp"
#include "server/store/store_error.hpp"
#include "server/store/store_facts.hpp"

#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

rocksdb::Options options_to_read(const StoreOptions& options, bool has_unfinished_write) {
    auto rocksdb = rocksdb_options(options, std::make_shared<CompactionWatch>());
    rocksdb.create_if_missing = false;
    // Everything before an unfinished write is known to be intact, so reading just ends there, as after
    // mend_after_crash().
    if (has_unfinished_write) rocksdb.wal_recovery_mode = rocksdb::WALRecoveryMode::kPointInTimeRecovery;
    return rocksdb;
}

/// Returns the sessions without a record. Unreadable data is reported when the sessions are read.
std::vector<SessionId> owners_without_record(rocksdb::DB& database, const LogEnds& ends) {
    std::set<SessionId> found;
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    for (const auto range_of : {&parts_of, &entries_of}) {
        for (iterator->Seek(range_of(0).begin); iterator->Valid();) {
            const std::string key = iterator->key().ToString();
            const auto owner = owner_of(key);
            if (!owner || !key.starts_with(range_of(0).begin.front())) break;
            if (!ends.revisions.contains(*owner)) found.insert(*owner);
            iterator->Seek(range_of(*owner).end);
        }
    }
    return {found.begin(), found.end()};
}

} // namespace

Result<AtRest> open_at_rest(const fs::path& directory, const StoreOptions& options) {
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
    auto ends = read_ends(*database, directory);
    if (!ends) return ends.error();

    AtRest store;
    store.unfinished_bytes = *unfinished ? (*unfinished)->bytes : 0;
    store.without_record = owners_without_record(*database, *ends);
    store.log = std::make_unique<RocksdbScanLog>(std::move(*locked), std::move(database), std::move(*ends), 0,
                                                 std::make_shared<CompactionWatch>(), nullptr, options);
    return store;
}

} // namespace scanloom::store
