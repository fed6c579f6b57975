#include "server/store/block_scan.hpp"

#include <rocksdb/options.h>

namespace scanloom::store {
namespace {

/// This many numbers are tried one by one, more than a block holds; then in growing steps.
constexpr std::uint64_t kOneByOne = 256;
constexpr std::uint64_t kGreatest = std::uint64_t{1} << 40; // no log is as long

} // namespace

BlockScan::BlockScan(const std::filesystem::path& table, const KeyRange& range, const rocksdb::Options& options)
    : range_(range), end_(range_.end), reader_(std::make_unique<rocksdb::SstFileReader>(options)) {
    if (!reader_->Open(table.native()).ok()) return;
    rocksdb::ReadOptions read;
    read.iterate_upper_bound = &end_;
    read.fill_cache = false;
    iterator_.reset(reader_->NewIterator(read));
    seek(0);
}

void BlockScan::next() {
    iterator_->Next();
    if (!iterator_->Valid() && !iterator_->status().ok()) skip_unreadable(*number_ + 1);
    update_number();
}

void BlockScan::seek(std::uint64_t number) {
    if (!try_to_seek(number)) skip_unreadable(number + 1);
    update_number();
}

/// @return whether the key there can be read, or the range ends
bool BlockScan::try_to_seek(std::uint64_t number) {
    iterator_->Seek(range_.begin + number_bytes(number));
    return iterator_->Valid() || iterator_->status().ok();
}

/// Goes to the first readable key with the number `first` or a greater one.
void BlockScan::skip_unreadable(std::uint64_t first) {
    for (std::uint64_t tried = 0; tried < kOneByOne; ++tried) {
        if (try_to_seek(first + tried)) return;
    }
    std::uint64_t unreadable = first + kOneByOne - 1;
    std::uint64_t readable = unreadable + kOneByOne;
    for (std::uint64_t step = kOneByOne; !try_to_seek(readable); readable += step) {
        if (readable > kGreatest) return; // the rest of the table is unreadable
        unreadable = readable;
        step *= 2;
    }
    while (unreadable + 1 < readable) { // binary search for the start of the readable part
        const auto middle = unreadable + (readable - unreadable) / 2;
        (try_to_seek(middle) ? readable : unreadable) = middle;
    }
    static_cast<void>(try_to_seek(readable));
}

/// Passes over keys that are too short for a number; a store has none.
void BlockScan::update_number() {
    for (number_.reset(); iterator_->Valid() && !number_;) {
        number_ = number_of(key().substr(range_.begin.size(), sizeof(std::uint64_t)));
        if (!number_) iterator_->Next();
    }
}

} // namespace scanloom::store
