#include "server/store/damaged_store.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>
#include <rocksdb/sst_file_reader.h>

#include <random>

/// Damaged stores, whose intact entries are read.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Key;
using testing::SizeIs;

constexpr Revision kInTable = 1000;
constexpr Revision kInLog = 40;

/// Two sessions, each with entries in a table, and one with some in the write-ahead log.
class DamagedStoreTest : public testing::Test {
protected:
    DamagedStoreTest() {
        {
            auto log = open_rocksdb(at("original")).value();
            for (const auto* record : {"one", "two", "removed"}) {
                const auto id = log->create_session(record).value();
                append_and_wait(*log, id, 1, distinct_entries(id, 1, kInTable)).value();
            }
        }
        log_ = open_without_compactions("original");
        log_->remove_session(3).value(); // a table still has its record
        for (Revision revision = kInTable + 1; revision <= kInTable + kInLog; ++revision) {
            append_and_wait(*log_, 1, revision, {distinct_entry(1, revision)}).value();
        }
        copy_store(at("original"), store());
    }

    [[nodiscard]] fs::path at(const char* name) const { return directory_.path() / name; }
    [[nodiscard]] fs::path store() const { return at("store"); }

    /// Opens a store on a disk that has room for tables, but not for compactions.
    [[nodiscard]] std::unique_ptr<ScanLog> open_without_compactions(const char* name) {
        StoreOptions options;
        options.env = disk_.env.get();
        disk_.files->set_free_bytes(options.disk_reserve_bytes + 1);
        return open_rocksdb(at(name), options).value();
    }

    /// Returns the table with the most entries.
    [[nodiscard]] fs::path largest_table() const {
        return std::ranges::max(files_like(store(), ".sst"), {}, [](const auto& file) { return fs::file_size(file); });
    }

    /// Returns the revisions that are read. Checks that each entry is the one that was stored, and that they ascend.
    std::set<Revision> found(const DamagedStore& damaged, SessionId session) {
        std::set<Revision> revisions;
        const auto read = damaged.read(session, [&](Revision revision, std::string_view entry) -> Result<> {
            EXPECT_EQ(entry, distinct_entry(session, revision));
            EXPECT_TRUE(revisions.empty() || *revisions.rbegin() < revision);
            revisions.insert(revision);
            return {};
        });
        EXPECT_TRUE(read);
        return revisions;
    }

    std::unique_ptr<DamagedStore> opened() {
        const auto before = files_in(store());
        auto damaged = DamagedStore::open(store());
        if (!damaged) throw std::runtime_error(damaged.error().message);
        EXPECT_EQ(files_in(store()), before) << "the store must not change";
        return std::move(*damaged);
    }

    void expect_a_removed_session_to_stay_removed(std::size_t step);

    TemporaryDirectory directory_;
    FaultyEnv disk_;
    std::unique_ptr<ScanLog> log_; // of the original
};

class DamagedStoreTrials : public DamagedStoreTest {};

TEST_F(DamagedStoreTest, FindsEverythingInAnIntactStore) {
    const auto damaged = opened();
    EXPECT_THAT(damaged->notes(), IsEmpty());
    ASSERT_THAT(damaged->sessions(), SizeIs(2)) << "the third was removed";
    EXPECT_EQ(damaged->sessions().at(1), "one");
    EXPECT_EQ(damaged->sessions().at(2), "two");
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInTable + kInLog));
    EXPECT_THAT(found(*damaged, 2), SizeIs(kInTable));
}

/// A block has 4 KiB, and the entries have 1.5 KB on average: a block may have one large and a few small ones.
constexpr std::size_t kInBlock = 12;

TEST_F(DamagedStoreTrials, ADamagedBlockCostsOnlyItsEntries) {
    std::mt19937 random(3);
    std::size_t kept = 0;
    for (int round = 0; round < 12; ++round) {
        copy_store(at("original"), store());
        const auto table = largest_table();
        for (int bits = 0; bits < 3; ++bits) { // in its blocks of entries
            flip_bit(table, random() % (fs::file_size(table) * 9 / 10), 1);
        }
        const auto damaged = opened();
        EXPECT_THAT(damaged->notes(), ElementsAre(HasSubstr("the entries in its readable blocks are kept")));
        const auto kept_now = found(*damaged, 1).size() + found(*damaged, 2).size();
        EXPECT_GE(kept_now, 2 * kInTable + kInLog - 3 * kInBlock);
        EXPECT_THAT(damaged->sessions(), SizeIs(2)) << "the third was removed";
        kept += kept_now;
    }
    EXPECT_LT(kept, 12 * (2 * kInTable + kInLog));
}

/// The last 4 KiB of a table have its footer and the top of its index. Before them are the parts of the index, each for
/// about 160 blocks.
TEST_F(DamagedStoreTrials, AFlippedBitInTheIndexCostsAPartOfTheTableOrTheTable) {
    const auto table = largest_table();
    const auto original = bytes_of(table);
    rocksdb::SstFileReader reader({});
    ASSERT_TRUE(reader.Open(table.native()).ok());
    const auto properties = reader.GetTableProperties();
    ASSERT_GE(properties->index_partitions, 4U);
    const auto index = properties->index_size - properties->top_level_index_size;
    std::size_t kept_of_parts = 0;
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        write_bytes(table, original);
        flip_bit(table, properties->data_size + random() % index, random() % 8);
        const auto damaged = opened();
        EXPECT_THAT(damaged->notes(), ElementsAre(HasSubstr("the entries in its readable blocks are kept")));
        const auto kept = found(*damaged, 1).size() + found(*damaged, 2).size();
        EXPECT_GE(kept, kInTable);
        kept_of_parts += kept;
    }
    EXPECT_LT(kept_of_parts, 20 * (2 * kInTable + kInLog));

    write_bytes(table, std::string_view(original).substr(0, original.size() - 1));
    const auto damaged = opened();
    EXPECT_THAT(damaged->notes(), ElementsAre(HasSubstr("its index cannot be read, and all its entries are lost")));
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInLog)) << "those in the write-ahead log";
}

TEST_F(DamagedStoreTest, KeepsEachCompleteWriteOfADamagedWriteAheadLog) {
    const auto log = only_file_like(store(), ".log");
    flip_bit(log, fs::file_size(log) / 2, 1);
    const auto damaged = opened();
    EXPECT_THAT(damaged->notes(), ElementsAre(HasSubstr("is damaged: at byte")));
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInTable + kInLog - 1));
}

TEST_F(DamagedStoreTest, KeepsEverythingWithoutAManifest) {
    flip_bit(only_file_like(store(), "MANIFEST-"), 60, 1);
    const auto expect_everything = [&] {
        const auto damaged = opened();
        EXPECT_THAT(found(*damaged, 1), SizeIs(kInTable + kInLog));
        EXPECT_THAT(found(*damaged, 2), SizeIs(kInTable));
    };
    expect_everything();
    fs::remove(only_file_like(store(), "MANIFEST-"));
    expect_everything();
    fs::remove(store() / "CURRENT");
    expect_everything();
}

/// Merged tables have sequence numbers of earlier and later changes. RocksDB rejects them next to other tables.
TEST_F(DamagedStoreTest, KeepsMergedTablesWithoutAManifest) {
    const auto append_round = [&](Revision first) {
        auto log = open_rocksdb(at("merged")).value();
        for (const SessionId id : {1, 2}) {
            if (first == 1) log->create_session("merged").value();
            append_and_wait(*log, id, first, distinct_entries(id, first, 300)).value();
        }
    };
    append_round(1);
    const auto merge = [&](int to_level) {
        rocksdb::Options options;
        options.compression = rocksdb::kNoCompression;
        options.disable_auto_compactions = true;
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open(options, at("merged").native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        std::vector<rocksdb::LiveFileMetaData> tables;
        database->GetLiveFilesMetaData(&tables);
        std::vector<std::string> fresh;
        for (const auto& table : tables) {
            if (table.level == 0) fresh.push_back(table.relative_filename);
        }
        rocksdb::CompactionOptions compaction;
        compaction.output_file_size_limit = 16 << 10; // so that sessions have tables of their own
        ASSERT_TRUE(database->CompactFiles(compaction, fresh, to_level).ok());
        database->GetLiveFilesMetaData(&tables);
        std::size_t within_another = 0;
        for (const auto& a : tables) {
            for (const auto& b : tables) {
                within_another += a.smallest_seqno > b.smallest_seqno && a.largest_seqno < b.largest_seqno ? 1 : 0;
            }
        }
        EXPECT_EQ(within_another > 0, to_level < 6);
    };
    merge(6); // where changes lose their numbers, as nothing lies below
    for (const Revision first : {301, 601}) append_round(first);
    merge(1);
    for (const Revision first : {901, 1201}) append_round(first);
    copy_store(at("merged"), store());
    EXPECT_GT(files_like(store(), ".sst").size(), 4U);
    fs::remove(store() / "CURRENT");
    const auto damaged = opened();
    for (const SessionId id : {1, 2}) {
        EXPECT_EQ(damaged->sessions().at(id), "merged");
        EXPECT_THAT(found(*damaged, id), SizeIs(1500));
    }
    EXPECT_EQ(damaged->damaged_files(), 1U) << "CURRENT";
}

/// Removals in tables can only be read with the manifest.
TEST_F(DamagedStoreTest, WithoutAManifestOnlyRemovalsInTheWriteAheadLogCount) {
    disk_.files->set_free_bytes(0); // without room, a removal is not moved to a table
    log_->remove_session(2).value();
    copy_store(at("original"), store());
    fs::remove(store() / "CURRENT");
    EXPECT_THAT(opened()->sessions(), ElementsAre(Key(1), Key(3)));
}

TEST_F(DamagedStoreTrials, AManifestThatEndsEarlyCostsNoTable) {
    {
        auto log = open_without_compactions("growing");
        for (SessionId id = 1; id <= 3; ++id) { // each in a table of its own, one after the other
            ASSERT_EQ(log->create_session("kept").value(), 2 * id - 1);
            append_and_wait(*log, 2 * id - 1, 1, distinct_entries(2 * id - 1, 1, 50)).value();
            log->remove_session(log->create_session("removed").value()).value(); // which writes a table
        }
        copy_store(at("growing"), store());
    }
    const auto manifest = only_file_like(store(), "MANIFEST-");
    const auto bytes = bytes_of(manifest);
    for (std::size_t left = bytes.size() - 1; left > 3; left -= std::min<std::size_t>(left, 7)) {
        write_bytes(manifest, std::string_view(bytes).substr(0, left));
        const auto damaged = opened();
        for (const SessionId id : {1, 3, 5}) {
            ASSERT_EQ(damaged->sessions().at(id), "kept") << left;
            ASSERT_THAT(found(*damaged, id), SizeIs(50)) << left;
        }
    }
}

TEST_F(DamagedStoreTest, AMissingTableCostsItsEntries) {
    const auto tables = files_like(store(), ".sst");
    for (const auto& table : tables) fs::remove(table);
    const auto damaged = opened();
    EXPECT_EQ(damaged->damaged_files(), tables.size());
    EXPECT_THAT(damaged->notes(), Each(HasSubstr(".sst is damaged: it is missing")));
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInLog));
    EXPECT_EQ(damaged->sessions().at(1), std::nullopt) << "its record was in a table";
}

TEST_F(DamagedStoreTest, ToleratesADamagedBlockAndAMissingManifestAtOnce) {
    flip_bit(largest_table(), fs::file_size(largest_table()) / 4, 1);
    fs::remove(only_file_like(store(), "MANIFEST-"));
    const auto damaged = opened();
    EXPECT_EQ(damaged->sessions().at(1), "one");
    EXPECT_GE(found(*damaged, 1).size() + found(*damaged, 2).size(), 2 * kInTable + kInLog - kInBlock);
}

TEST_F(DamagedStoreTest, ReportsAMissingWriteAheadLog) {
    fs::remove(only_file_like(store(), ".log"));
    const auto damaged = opened();
    EXPECT_THAT(damaged->notes(), ElementsAre(HasSubstr("write-ahead log is damaged: it is missing")));
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInTable));
}

TEST_F(DamagedStoreTest, RefusesAStoreInUseAndADirectoryWithoutOne) {
    const auto server = open_rocksdb(store()).value();
    EXPECT_EQ(DamagedStore::open(store()).error().code, Errc::kConflict);
    EXPECT_EQ(DamagedStore::open(at("nowhere")).error().code, Errc::kNotFound);
    fs::create_directory(at("empty"));
    EXPECT_EQ(DamagedStore::open(at("empty")).error().code, Errc::kNotFound) << "a disk that is not mounted";
}

/// The table that has the session is damaged; the removal is in a later table.
void DamagedStoreTest::expect_a_removed_session_to_stay_removed(std::size_t step) {
    { open_rocksdb(store()).value()->remove_session(1).value(); }
    const auto table = largest_table();
    const auto bytes = bytes_of(table);
    for (std::size_t at = 500; at < bytes.size() * 9 / 10; at += step) {
        write_bytes(table, bytes);
        flip_bit(table, at, 1);
        const auto damaged = opened();
        EXPECT_THAT(damaged->sessions(), SizeIs(1)) << "byte " << at;
        EXPECT_GE(found(*damaged, 2).size(), kInTable - kInBlock);
    }
}

TEST_F(DamagedStoreTest, ARemovedSessionStaysRemoved) { expect_a_removed_session_to_stay_removed(800'000); }

TEST_F(DamagedStoreTrials, ARemovedSessionStaysRemoved) { expect_a_removed_session_to_stay_removed(150'000); }

TEST_F(DamagedStoreTest, AnUnreadableSectorCostsTheEntriesInItsBlocks) {
    const FaultyEnv disk;
    const auto make_unreadable = [&](const fs::path& file, std::uint64_t at) {
        disk.files->set_unreadable(file.filename(), at);
    };
    make_unreadable(largest_table(), fs::file_size(largest_table()) / 3);
    make_unreadable(only_file_like(store(), ".log"), 3000);
    StoreOptions options;
    options.env = disk.env.get();
    const auto damaged = DamagedStore::open(store(), options).value();
    EXPECT_EQ(damaged->damaged_files(), 2U);
    EXPECT_THAT(damaged->notes(), Contains(HasSubstr("the disk cannot read 4096 bytes of it")));
    EXPECT_THAT(damaged->notes(), Contains(HasSubstr("Input/output error")));
    constexpr std::size_t kInPage = 4096 / 100; // entries in the log have more than a hundred bytes
    const auto kept = found(*damaged, 1).size() + found(*damaged, 2).size();
    EXPECT_GE(kept, 2 * kInTable + kInLog - kInBlock - kInPage);
    EXPECT_LT(kept, 2 * kInTable + kInLog);
    EXPECT_EQ(damaged->sessions().at(1), "one");
    EXPECT_EQ(damaged->sessions().at(2), "two");
}

/// The record and the first entries of a session are in a damaged write; RocksDB knows nothing of the session then.
TEST_F(DamagedStoreTest, ASessionWhoseCreationIsLostIsNotTakenForARemovedOne) {
    {
        auto log = open_rocksdb(store()).value();
        const auto session = log->create_session("four").value();
        for (Revision revision = 1; revision <= 10; ++revision) {
            append_and_wait(*log, session, revision, {distinct_entry(session, revision)}).value();
        }
        ASSERT_EQ(session, 4U);
        copy_store(store(), at("killed"));
    }
    copy_store(at("killed"), store());
    const auto log = files_like(store(), ".log").back();
    flip_bit(log, bytes_of(log).find("four"), 1);
    const auto damaged = opened();
    EXPECT_EQ(damaged->sessions().at(4), std::nullopt);
    EXPECT_THAT(found(*damaged, 4), SizeIs(10));
}

TEST_F(DamagedStoreTest, IgnoresDirectoriesNamedLikeFiles) {
    fs::create_directory(store() / "000999.log");
    fs::create_directory(store() / "000999.sst");
    const auto damaged = DamagedStore::open(store()).value();
    EXPECT_THAT(found(*damaged, 1), SizeIs(kInTable + kInLog));
}

} // namespace
} // namespace scanloom::store
