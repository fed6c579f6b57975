#include "server/store/open_store.hpp"

#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_scan_log.hpp"

namespace scanloom::store {

bool is_in_database(const std::filesystem::path& store) { return postgres::is_place(store.native()); }

Result<> check_address(const std::string& address) {
    const auto place = postgres::parse_place(address);
    return place ? Result<>() : Result<>(place.error());
}

std::string shown(const std::filesystem::path& store) {
    if (!is_in_database(store)) return store.native();
    const auto place = postgres::parse_place(store.native());
    return place ? place->text : "the database";
}

Result<std::unique_ptr<ScanLog>> open_store(const std::filesystem::path& store, const StoreOptions& options) {
    if (!is_in_database(store)) return open_rocksdb(store, options);
    return open_postgres(store.native(), {.allow_unreplicated = options.allow_unreplicated,
                                          .node = options.node,
                                          .bytes_max = options.bytes_max,
                                          .on_unreadable = options.on_unreadable});
}

Result<NewStore> NewStore::begin(const std::filesystem::path& store, const StoreOptions& options) {
    NewStore begun(store);
    if (!is_in_database(store)) {
        auto directory = UnfinishedStore::begin(store, {});
        if (!directory) return directory.error();
        begun.directory_ = std::move(*directory);
    }
    auto log = begun.directory_ ? begun.directory_->open_log()
                                : open_postgres(store.native(), {.allow_unreplicated = options.allow_unreplicated,
                                                                 .node = "a copy",
                                                                 .is_unfinished = true});
    if (!log) return log.error();
    begun.log_ = std::move(*log);
    return begun;
}

Result<> NewStore::finish() {
    log_.reset();
    return directory_ ? directory_->finish() : finish_postgres(store_.native());
}

Result<ReadOnlyStore> open_store_read_only(const std::filesystem::path& store) {
    return is_in_database(store) ? open_postgres_read_only(store.native()) : open_read_only(store);
}

} // namespace scanloom::store
