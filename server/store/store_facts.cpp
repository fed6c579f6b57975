#include "server/store/store_facts.hpp"

#include "server/store/advice.hpp"
#include "server/store/log_end.hpp"
#include "server/store/record.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

Error facts_failure(const fs::path& directory, std::string_view what) {
    return {Errc::kStoreFailed, fmt::format("the store {} cannot be opened: {}", directory.native(), what)};
}

/// Reads a number that the store keeps about itself; nullopt if it was never written.
Result<std::optional<std::uint64_t>> read_number(rocksdb::DB& database, const fs::path& directory,
                                                 std::string_view key) {
    std::string sealed_value;
    const auto status = database.Get({}, rocksdb::Slice(key.data(), key.size()), &sealed_value);
    if (status.IsNotFound()) return std::optional<std::uint64_t>{};
    if (!status.ok()) return cannot_open(directory, status);
    const auto value = unsealed(key, sealed_value);
    const auto number = value ? number_of(*value) : std::nullopt;
    if (!number) return facts_failure(directory, fmt::format("its record '{}' is damaged; {}", key, kBringBack));
    return number;
}

bool is_empty(rocksdb::DB& database) {
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    iterator->SeekToFirst();
    return !iterator->Valid() && iterator->status().ok();
}

} // namespace

Error cannot_open(const fs::path& directory, const rocksdb::Status& status) {
    if (status.IsCorruption()) {
        return {Errc::kDataLoss, fmt::format("the store {} cannot be opened: it is damaged ({}); {}",
                                             directory.native(), status.ToString(), kBringBack)};
    }
    if (status.IsNoSpace()) return facts_failure(directory, fmt::format("the disk is full ({})", status.ToString()));
    return facts_failure(directory, status.ToString());
}

Result<bool> must_write_format(rocksdb::DB& database, const fs::path& directory) {
    const auto version = read_number(database, directory, kFormatKey);
    if (!version) return version.error();
    if (!*version) {
        if (is_empty(database)) return true;
        return facts_failure(
            directory, fmt::format("it holds a RocksDB database without the format record of scanloom-server; name "
                                   "another directory if it is another program's; if it is not, {}",
                                   kBringBack));
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
        if (*session >= ends.next_session)
            return facts_failure(directory, fmt::format("its count of sessions is damaged; {}", kBringBack));
        const auto end = end_of_log(database, directory.native(), *session); // damage of one does not affect the others
        ends.revisions.emplace(*session, end ? *end : 0);
        if (!end) ends.damaged.emplace(*session, end.error());
    }
    if (!sessions->status().ok()) return cannot_open(directory, sessions->status());
    return ends;
}

} // namespace scanloom::store
