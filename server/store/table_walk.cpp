#include "server/store/table_walk.hpp"

#include <rocksdb/options.h>

namespace scanloom::store {
namespace {

/// This many revisions are tried one by one, more than a block of 32 KiB holds of common scans; then in growing steps.
constexpr Revision kOneByOne = 1024;
constexpr Revision kFarthest = Revision{1} << 40; // no log is as long

} // namespace

TableWalk::TableWalk(const std::filesystem::path& table, SessionId session, const rocksdb::Options& options)
    : session_(session), range_(entries_of(session)), end_(range_.end),
      reader_(std::make_unique<rocksdb::SstFileReader>(options)) {
    if (!reader_->Open(table.native()).ok()) {
        met_damage_ = true;
        return;
    }
    rocksdb::ReadOptions read;
    read.iterate_upper_bound = &end_;
    read.fill_cache = false;
    iterator_.reset(reader_->NewIterator(read));
    iterator_->Seek(range_.begin);
    settle(0);
}

void TableWalk::next() {
    const Revision at = revision();
    iterator_->Next();
    settle(at);
}

/// Pre: `at` is the last revision that was read.
void TableWalk::settle(Revision at) {
    if (!iterator_->Valid() && !iterator_->status().ok()) go_on_behind(at + 1);
}

/// @return whether the entry there can be read, or the table ends
bool TableWalk::seek(Revision revision) {
    iterator_->Seek(entry_key(session_, revision));
    return iterator_->Valid() || iterator_->status().ok();
}

void TableWalk::go_on_behind(Revision unreadable) {
    met_damage_ = true;
    for (Revision tried = 0; tried < kOneByOne; ++tried) {
        if (seek(unreadable + tried)) return;
    }
    Revision last_unreadable = unreadable + kOneByOne - 1;
    Revision readable = last_unreadable + kOneByOne;
    while (!seek(readable)) {
        if (readable > kFarthest) return; // the rest of the table is unreadable
        last_unreadable = readable;
        readable *= 2;
    }
    while (last_unreadable + 1 < readable) { // binary search for the start of the readable part
        const Revision middle = last_unreadable + (readable - last_unreadable) / 2;
        (seek(middle) ? readable : last_unreadable) = middle;
    }
    static_cast<void>(seek(readable));
}

} // namespace scanloom::store
