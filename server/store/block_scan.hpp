#pragma once

#include "server/store/record.hpp"
#include "server/store/rocksdb_store.hpp"

#include <rocksdb/sst_file_reader.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::store {

/// Visits the keys of one table file that consist of a prefix and a number, by ascending number, and skips blocks that
/// cannot be read.
///
/// A table is read block by block. The content of a block with a wrong checksum is unknown, and so is where the next
/// one begins. Because the keys end with numbers, it is found by seeking one number after another.
/// Threads: one.
class BlockScan {
public:
    /// A table that cannot be opened has no keys.
    /// @param range    its begin is the prefix; the number is the 8 bytes after it
    /// @param options  options_of_table()
    BlockScan(const std::filesystem::path& table, const KeyRange& range, const rocksdb::Options& options);

    /// Whether there is a key; false behind the last one.
    [[nodiscard]] bool valid() const { return number_.has_value(); }

    /// Pre, for these three: valid(). The bytes are valid until the next call of next() or seek().
    [[nodiscard]] std::uint64_t number() const { return *number_; }
    [[nodiscard]] std::string_view key() const { return iterator_->key().ToStringView(); }
    [[nodiscard]] std::string_view sealed_value() const { return iterator_->value().ToStringView(); }

    /// Goes to the next key.
    /// Pre: valid().
    void next();

    /// Goes to the first readable key with this number or a greater one.
    void seek(std::uint64_t number);

private:
    [[nodiscard]] bool try_to_seek(std::uint64_t number);
    void skip_unreadable(std::uint64_t first);
    void update_number();

    const KeyRange range_;
    const rocksdb::Slice end_;
    std::unique_ptr<rocksdb::SstFileReader> reader_;
    std::unique_ptr<rocksdb::Iterator> iterator_; // destroyed before its reader
    std::optional<std::uint64_t> number_;         // of the current key
};

} // namespace scanloom::store
