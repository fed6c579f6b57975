#include "server/store/table_check.hpp"

#include "server/store/rocksdb_options.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/sst_file_reader.h>

namespace scanloom::store {

Result<> check_table(const std::filesystem::path& table, const StoreOptions& options) {
    rocksdb::SstFileReader reader(options_of_table(options));
    auto status = reader.Open(table.native());
    if (status.ok()) status = reader.VerifyChecksum();
    if (status.ok()) return {};
    return Error{Errc::kDataLoss, fmt::format("{} is damaged ({}); {}", table.native(), status.ToString(), kBringBack)};
}

} // namespace scanloom::store
