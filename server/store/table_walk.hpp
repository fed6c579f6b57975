#pragma once

#include "server/store/record.hpp"

#include <rocksdb/sst_file_reader.h>

#include <filesystem>
#include <memory>
#include <string>

namespace scanloom::store {

/// Visits the log entries of one session in one table file by ascending revision and skips parts that cannot be read.
///
/// A table is read block by block, and the content of a block with a wrong checksum is unknown. Because keys are
/// numbers, the entries behind it are found by seeking one revision after another.
class TableWalk {
public:
    /// A table that cannot be opened has no entries.
    TableWalk(const std::filesystem::path& table, SessionId session, const rocksdb::Options& options);

    [[nodiscard]] bool valid() const { return iterator_ != nullptr && iterator_->Valid(); }

    /// Pre: valid().
    [[nodiscard]] Revision revision() const { return *revision_of(iterator_->key().ToStringView()); }
    [[nodiscard]] std::string_view key() const { return iterator_->key().ToStringView(); }
    [[nodiscard]] std::string_view sealed_value() const { return iterator_->value().ToStringView(); }
    void next();

    /// Whether any part of the table could not be read so far.
    [[nodiscard]] bool met_damage() const noexcept { return met_damage_; }

private:
    [[nodiscard]] bool seek(Revision revision);
    void settle(Revision at);
    void go_on_behind(Revision unreadable);

    const SessionId session_;
    const KeyRange range_;
    const rocksdb::Slice end_;
    std::unique_ptr<rocksdb::SstFileReader> reader_;
    std::unique_ptr<rocksdb::Iterator> iterator_; // destroyed before its reader
    bool met_damage_ = false;
};

} // namespace scanloom::store
