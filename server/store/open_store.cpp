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
    return open_postgres(store.native(),
                         {.allow_unreplicated = options.allow_unreplicated, .on_unreadable = options.on_unreadable});
}

Result<ReadOnlyStore> open_store_read_only(const std::filesystem::path& store) {
    return is_in_database(store) ? open_postgres_read_only(store.native()) : open_read_only(store);
}

} // namespace scanloom::store
