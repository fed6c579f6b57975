#include "server/store/salvage.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>

#include <random>

/// Damaged stores, of which everything intact is read.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Revision kInTable = 1000;
constexpr Revision kInLog = 40;

/// Two sessions, each with entries in a table, and one with some in the write-ahead log.
class SalvageTest : public testing::Test {
protected:
    SalvageTest() {
        {
            auto log = open_rocksdb(at("original")).value();
            for (const auto* record : {"one", "two", "removed"}) {
                const auto id = log->create_session(record).value();
                append_and_wait(*log, id, 1, distinct_entries(id, 1, kInTable)).value();
            }
        }
        auto log = open_rocksdb(at("original")).value();
        log->remove_session(3).value(); // of which a table still has the record
        for (Revision revision = kInTable + 1; revision <= kInTable + kInLog; ++revision) {
            append_and_wait(*log, 1, revision, {distinct_entry(1, revision)}).value();
        }
        copy_store(at("original"), store());
    }

    [[nodiscard]] fs::path at(const char* name) const { return directory_.path() / name; }
    [[nodiscard]] fs::path store() const { return at("store"); }

    /// The one with the most entries.
    [[nodiscard]] fs::path largest_table() const {
        return std::ranges::max(files_like(store(), ".sst"), {}, [](const auto& file) { return fs::file_size(file); });
    }

    /// What is found; each entry is the one that was stored, and they rise.
    std::set<Revision> found(const Salvage& salvage, SessionId session) {
        std::set<Revision> revisions;
        const auto read = salvage.read(session, [&](Revision revision, std::string_view entry) -> Result<> {
            EXPECT_EQ(entry, distinct_entry(session, revision));
            EXPECT_TRUE(revisions.empty() || *revisions.rbegin() < revision);
            revisions.insert(revision);
            return {};
        });
        EXPECT_TRUE(read);
        return revisions;
    }

    std::unique_ptr<Salvage> salvaged() {
        const auto before = files_in(store());
        auto salvage = salvaged_of_files();
        EXPECT_EQ(files_in(store()), before) << "nothing of the old one is changed";
        return salvage;
    }

    std::unique_ptr<Salvage> salvaged_of_files() {
        auto salvage = Salvage::open(store(), at("copy"));
        if (!salvage) throw std::runtime_error(salvage.error().message);
        return std::move(*salvage);
    }

    TemporaryDirectory directory_;
};

class SalvageTrials : public SalvageTest {};

TEST_F(SalvageTest, OfAStoreThatIsWholeEverythingIsFoundAndNothingIsLeftBehind) {
    {
        const auto salvage = salvaged();
        EXPECT_THAT(salvage->tables().notes(), IsEmpty());
        ASSERT_THAT(salvage->sessions(), SizeIs(2)) << "the third was removed";
        EXPECT_EQ(salvage->sessions().at(1), "one");
        EXPECT_EQ(salvage->sessions().at(2), "two");
        EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog));
        EXPECT_THAT(found(*salvage, 2), SizeIs(kInTable));
    }
    EXPECT_FALSE(fs::exists(at("copy")));
}

TEST_F(SalvageTrials, OfATableWithBadBlocksAllIsKeptButTheEntriesThatAreHit) {
    std::mt19937 random(3);
    std::size_t kept = 0;
    for (int round = 0; round < 12; ++round) {
        copy_store(at("original"), store());
        const auto table = largest_table();
        for (int bits = 0; bits < 3; ++bits) { // in its blocks of entries
            flip_bit(table, random() % (fs::file_size(table) * 9 / 10), 1);
        }
        const auto salvage = salvaged();
        EXPECT_THAT(salvage->tables().notes(), ElementsAre(HasSubstr("is damaged: what is intact of it was taken")));
        const auto kept_now = found(*salvage, 1).size() + found(*salvage, 2).size();
        EXPECT_GE(kept_now, 2 * kInTable + kInLog - 3);
        EXPECT_THAT(salvage->sessions(), SizeIs(2)) << "the third was removed";
        kept += kept_now;
    }
    EXPECT_LT(kept, 12 * (2 * kInTable + kInLog));
}

TEST_F(SalvageTest, OfATableWithoutItsEndNothingIsLostButThatEnd) {
    const auto table = largest_table();
    const auto bytes = bytes_of(table);
    for (const std::size_t cut : {std::size_t{1}, std::size_t{53}, std::size_t{4000}}) { // footer and index, no entries
        write_bytes(table, bytes.substr(0, bytes.size() - cut));
        const auto salvage = salvaged();
        EXPECT_EQ(salvage->sessions().at(1), "one");
        EXPECT_EQ(salvage->sessions().at(2), "two");
        EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog)) << cut;
        EXPECT_THAT(found(*salvage, 2), SizeIs(kInTable)) << cut;
    }
    write_bytes(table, bytes.substr(0, bytes.size() / 2));
    const auto salvage = salvaged();
    const auto kept = found(*salvage, 1).size() + found(*salvage, 2).size();
    EXPECT_GE(kept, (2 * kInTable + kInLog) / 3);
}

TEST_F(SalvageTrials, AFlippedBitAnywhereInTheEndOfATableCostsNothing) {
    const auto original = bytes_of(largest_table());
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        const auto table = largest_table();
        write_bytes(table, original);
        flip_bit(table, original.size() - 1 - random() % 2000, random() % 8);
        const auto salvage = salvaged();
        EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog));
        EXPECT_THAT(found(*salvage, 2), SizeIs(kInTable));
    }
}

TEST_F(SalvageTest, OfTheWriteAheadLogEachWholeWriteIsTaken) {
    const auto log = only_file_like(store(), ".log");
    flip_bit(log, fs::file_size(log) / 2, 1);
    const auto salvage = salvaged();
    EXPECT_THAT(salvage->tables().notes(), ElementsAre(HasSubstr("is damaged: from byte")));
    EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog - 1));
}

TEST_F(SalvageTest, AManifestThatIsDamagedOrGoneIsMadeAgain) {
    flip_bit(only_file_like(store(), "MANIFEST-"), 60, 1);
    const auto expect_all = [&] {
        const auto salvage = salvaged();
        EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog));
        EXPECT_THAT(found(*salvage, 2), SizeIs(kInTable));
    };
    expect_all();
    fs::remove(only_file_like(store(), "MANIFEST-"));
    expect_all();
    fs::remove(store() / "CURRENT");
    expect_all();
}

/// Tables that were merged have numbers of earlier and later changes; RocksDB minds when it finds them beside others.
TEST_F(SalvageTest, WithoutAManifestMergedTablesAreTakenToo) {
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
    const auto salvage = salvaged();
    for (const SessionId id : {1, 2}) {
        EXPECT_EQ(salvage->sessions().at(id), "merged");
        EXPECT_THAT(found(*salvage, id), SizeIs(1500));
    }
    EXPECT_EQ(salvage->tables().damaged_files(), 1U) << "CURRENT";
}

TEST_F(SalvageTest, WithoutAManifestASessionThatWasRemovedDoesNotComeBack) {
    fs::remove(store() / "CURRENT"); // its removal is in the write-ahead log
    EXPECT_THAT(salvaged()->sessions(), SizeIs(2));
    copy_store(at("original"), store());
    { auto log = open_rocksdb(store()).value(); } // which writes that log into a table
    fs::remove(store() / "CURRENT");
    EXPECT_THAT(salvaged()->sessions(), SizeIs(2));
}

TEST_F(SalvageTrials, AManifestThatEndsEarlyTakesNoTableAlong) {
    {
        auto log = open_rocksdb(at("growing")).value();
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
        const auto salvage = salvaged();
        for (const SessionId id : {1, 3, 5}) {
            ASSERT_EQ(salvage->sessions().at(id), "kept") << left;
            ASSERT_THAT(found(*salvage, id), SizeIs(50)) << left;
        }
    }
}

TEST_F(SalvageTest, ATableThatIsGoneTakesItsEntriesAlong) {
    const auto tables = files_like(store(), ".sst");
    for (const auto& table : tables) fs::remove(table);
    const auto salvage = salvaged();
    EXPECT_GE(salvage->tables().damaged_files(), 1U);
    EXPECT_THAT(salvage->tables().notes(), Contains(HasSubstr(".sst is damaged: it is missing, and maybe others")));
    EXPECT_THAT(found(*salvage, 1), SizeIs(kInLog));
    EXPECT_EQ(salvage->sessions().at(1), std::nullopt) << "its record was in a table";
}

TEST_F(SalvageTest, ATableWithABadBlockAndAManifestThatIsGoneAreBothOvercome) {
    flip_bit(largest_table(), fs::file_size(largest_table()) / 4, 1);
    fs::remove(only_file_like(store(), "MANIFEST-"));
    const auto salvage = salvaged();
    EXPECT_EQ(salvage->sessions().at(1), "one");
    EXPECT_GE(found(*salvage, 1).size() + found(*salvage, 2).size(), 2 * kInTable + kInLog - 1);
}

TEST_F(SalvageTest, AWriteAheadLogThatIsGoneIsTold) {
    fs::remove(only_file_like(store(), ".log"));
    const auto salvage = salvaged();
    EXPECT_THAT(salvage->tables().notes(), ElementsAre(HasSubstr("write-ahead log is damaged: it is missing")));
    EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable));
}

TEST_F(SalvageTest, AServerKeepsItOutAndWhereThereIsNoStoreThatIsSaid) {
    const auto server = open_rocksdb(store()).value();
    EXPECT_EQ(Salvage::open(store(), at("copy")).error().code, Errc::kConflict);
    EXPECT_EQ(Salvage::open(at("nowhere"), at("copy")).error().code, Errc::kNotFound);
    fs::create_directory(at("empty"));
    EXPECT_EQ(Salvage::open(at("empty"), at("copy")).error().code, Errc::kNotFound) << "a disk that is not mounted";
}

/// Wherever the table is damaged that still has it: what the table after it says holds.
TEST_F(SalvageTest, ASessionThatWasRemovedDoesNotComeBack) {
    { open_rocksdb(store()).value()->remove_session(1).value(); }
    const auto table = largest_table();
    const auto bytes = bytes_of(table);
    for (std::size_t at = 500; at < bytes.size() * 9 / 10; at += 150'000) {
        write_bytes(table, bytes);
        flip_bit(table, at, 1);
        const auto salvage = salvaged();
        EXPECT_THAT(salvage->sessions(), SizeIs(1)) << "byte " << at;
        EXPECT_GE(found(*salvage, 2).size(), kInTable - 1);
    }
}

TEST_F(SalvageTest, WhatTheDiskCannotReadCostsTheEntriesThatLieThereAndNoOther) {
    const FaultyEnv disk;
    const auto make_unreadable = [&](const fs::path& file, std::uint64_t at) {
        disk.files->set_unreadable(file.filename(), at);
    };
    make_unreadable(largest_table(), fs::file_size(largest_table()) / 3);
    make_unreadable(only_file_like(store(), ".log"), 3000);
    make_unreadable(only_file_like(store(), "MANIFEST-"), 50);
    StoreOptions options;
    options.env = disk.env.get();
    const auto salvage = Salvage::open(store(), at("copy"), options).value();
    EXPECT_EQ(salvage->tables().damaged_files(), 3U);
    EXPECT_THAT(salvage->tables().notes(), Contains(HasSubstr("the disk cannot read 4096 bytes of it")).Times(2));
    constexpr std::size_t kInPage = 4096 / 100; // entries have more than a hundred bytes
    EXPECT_GE(found(*salvage, 1).size() + found(*salvage, 2).size(), 2 * kInTable + kInLog - 2 * kInPage);
    EXPECT_LT(found(*salvage, 1).size() + found(*salvage, 2).size(), 2 * kInTable + kInLog);
    EXPECT_EQ(salvage->sessions().at(1), "one");
    EXPECT_EQ(salvage->sessions().at(2), "two");
}

TEST_F(SalvageTest, WhatIsNoFileOfTheStoresIsPassedOver) {
    fs::create_directory(store() / "000999.log");
    fs::create_directory(store() / "000999.sst");
    const auto salvage = salvaged_of_files();
    EXPECT_THAT(found(*salvage, 1), SizeIs(kInTable + kInLog));
}

} // namespace
} // namespace scanloom::store
