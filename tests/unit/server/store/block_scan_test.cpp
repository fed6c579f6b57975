#include "server/store/block_scan.hpp"

#include "server/store/compaction.hpp"
#include "server/store/rocksdb_options.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/sst_file_writer.h>

#include <memory>
#include <vector>

/// Tables whose blocks or index are damaged.
namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Revision kEntries = 20'000; // of 600 bytes: about 960 for each part of the index

/// A table with the entries of session 1.
class BlockScanTest : public testing::Test {
protected:
    BlockScanTest() {
        rocksdb::SstFileWriter writer({}, rocksdb_options({}, std::make_shared<CompactionWatch>()));
        EXPECT_TRUE(writer.Open(table_.native()).ok());
        for (Revision revision = 1; revision <= kEntries; ++revision) {
            const auto key = entry_key(1, revision);
            EXPECT_TRUE(writer.Put(key, sealed(key, std::string(600, 'e'))).ok());
        }
        EXPECT_TRUE(writer.Finish().ok());
        rocksdb::SstFileReader reader(options_);
        EXPECT_TRUE(reader.Open(table_.native()).ok());
        data_size_ = reader.GetTableProperties()->data_size;
    }

    struct Gap {
        Revision first;
        Revision last;
    };

    /// Returns the revisions that are not visited.
    [[nodiscard]] std::vector<Gap> gaps() const {
        std::vector<Gap> found;
        Revision expected = 1;
        for (BlockScan scan(table_, entries_of(1), options_); scan.valid(); scan.next()) {
            if (scan.number() != expected) found.push_back({expected, scan.number() - 1});
            expected = scan.number() + 1;
        }
        if (expected <= kEntries) found.push_back({expected, kEntries});
        return found;
    }

    TemporaryDirectory directory_;
    const std::filesystem::path table_ = directory_.path() / "table.sst";
    const rocksdb::Options options_ = options_of_table({});
    std::uint64_t data_size_ = 0;
};

TEST_F(BlockScanTest, VisitsEveryEntryOfAnIntactTable) { EXPECT_THAT(gaps(), IsEmpty()); }

TEST_F(BlockScanTest, SkipsADamagedBlock) {
    flip_bit(table_, data_size_ / 2, 1);
    const auto lost = gaps();
    ASSERT_THAT(lost, SizeIs(1));
    EXPECT_LE(lost[0].last - lost[0].first, 7U);
}

TEST_F(BlockScanTest, KeepsTheEntriesBetweenTwoDamagedPartsOfTheIndex) {
    constexpr std::size_t kPart = 4096;
    flip_bit(table_, data_size_ + 1 * kPart + kPart / 2, 1);
    flip_bit(table_, data_size_ + 3 * kPart + kPart / 2, 1);
    const auto lost = gaps();
    ASSERT_THAT(lost, SizeIs(2));
    for (const auto& gap : lost) EXPECT_LT(gap.last - gap.first, 1200U);
    EXPECT_GT(lost[1].first - lost[0].last, 800U);
}

TEST_F(BlockScanTest, SeeksByNumber) {
    BlockScan owners(table_, {std::string(kEntriesBegin), std::string(kEntriesEnd)}, options_);
    std::vector<std::uint64_t> sessions;
    for (; owners.valid(); owners.seek(owners.number() + 1)) sessions.push_back(owners.number());
    EXPECT_THAT(sessions, ElementsAre(1));
}

TEST_F(BlockScanTest, ATableThatCannotBeOpenedHasNoKeys) {
    write_bytes(table_, bytes_of(table_).substr(0, data_size_));
    EXPECT_FALSE(BlockScan(table_, entries_of(1), options_).valid());
}

} // namespace
} // namespace scanloom::store
