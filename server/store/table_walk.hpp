#pragma once

#include "server/store/record.hpp"

#include <rocksdb/sst_file_reader.h>

#include <filesystem>
#include <memory>
#include <string>

namespace scanloom::store {

/// The log entries of one session in one table file, by rising revision, going on behind whatever cannot be read.
///
/// A table is read block by block, and of a block that does not match its checksum nothing is known, not even what is
/// in it. As keys are numbers, what comes behind it is found by asking for one number after another.
class TableWalk {
public:
    /// A table that cannot be opened has no entries.
    TableWalk(const std::filesystem::path& table, SessionId session, const rocksdb::Options& options);

    [[nodiscard]] bool valid() const { return iterator_ != nullptr && iterator_->Valid(); }

    /// Pre  valid().
    [[nodiscard]] Revision revision() const { return *revision_of(iterator_->key().ToStringView()); }
    [[nodiscard]] std::string_view key() const { return iterator_->key().ToStringView(); }
    [[nodiscard]] std::string_view sealed_value() const { return iterator_->value().ToStringView(); }
    void next();

    /// Whether anything of the table could not be read so far.
    [[nodiscard]] bool met_damage() const noexcept { return met_damage_; }

private:
    [[nodiscard]] bool seek(Revision revision);
    void settle(Revision at);
    void go_on_behind(Revision unreadable);

    const SessionId session_;
    const KeyRange range_;
    const rocksdb::Slice end_;
    std::unique_ptr<rocksdb::SstFileReader> reader_;
    std::unique_ptr<rocksdb::Iterator> iterator_; // before its reader
    bool met_damage_ = false;
};

} // namespace scanloom::store
