#include "server/store/store_facts.hpp"

#include "server/store/log_end.hpp"
#include "server/store/record.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

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
                       kBringBack);
    }
    return number;
}

bool is_empty(rocksdb::DB& database) {
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    iterator->SeekToFirst();
    return !iterator->Valid() && iterator->status().ok();
}

} // namespace

Result<bool> must_write_format(rocksdb::DB& database, const fs::path& directory) {
    const auto version = read_number(database, directory, kFormatKey);
    if (!version) return version.error();
    if (!*version) {
        if (is_empty(database)) return true;
        return failure("the store {} cannot be opened: it holds a RocksDB database without the format record of "
                       "scanloom-server; name another directory if it is another program's; if it is not, {}",
                       directory.native(), kBringBack);
    }
    if (**version <= kFormatVersion) return **version < kFormatVersion;
    return Error{Errc::kUnsupportedVersion,
                 fmt::format("the store {} was written by a newer scanloom-server (format {}, this one knows up to "
                             "{}); update the server",
                             directory.native(), **version, kFormatVersion)};
}

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
                           kBringBack);
        }
        const auto end = end_of_log(database, directory.native(), *session); // damage of one does not affect the others
        ends.revisions.emplace(*session, end ? *end : 0);
        if (!end) ends.damaged.emplace(*session, end.error());
    }
    if (!sessions->status().ok()) return cannot_open(directory, sessions->status());
    return ends;
}

} // namespace scanloom::store
