#include "server/store/log_file.hpp"
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <random>

/// Files that a crash cut short open; damaged files are reported.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr Revision kBatches = 12;
constexpr Revision kBatchEntries = 5;

/// A store killed after a dozen appends, all of them still in its write-ahead log.
class KilledStore : public testing::Test {
protected:
    KilledStore() {
        auto log = open_rocksdb(original()).value();
        session_ = log->create_session("a session").value();
        const auto write_ahead_log = only_file_like(original(), ".log");
        ends_.push_back(fs::file_size(write_ahead_log));
        for (Revision batch = 0; batch < kBatches; ++batch) {
            const Revision first = 1 + batch * kBatchEntries;
            append_and_wait(*log, session_, first, distinct_entries(session_, first, kBatchEntries)).value();
            ends_.push_back(fs::file_size(write_ahead_log));
        }
        copy_store(original(), killed());
    }

    [[nodiscard]] fs::path original() const { return directory_.path() / "original"; }
    [[nodiscard]] fs::path killed() const { return directory_.path() / "killed"; }
    [[nodiscard]] fs::path copy() const { return directory_.path() / "copy"; }

    /// Expects exactly the appends whose writes end within the first `bytes`.
    void expect_prefix(std::size_t bytes) {
        const auto log = open_rocksdb(copy());
        ASSERT_TRUE(log) << log.error().message;
        if (bytes < ends_.front()) {
            EXPECT_THAT((*log)->sessions().value(), IsEmpty());
            return;
        }
        const auto whole =
            static_cast<Revision>(std::upper_bound(ends_.begin(), ends_.end(), bytes) - ends_.begin()) - 1;
        EXPECT_EQ(entries_after(**log, session_, 0).value(), distinct_entries(session_, 1, whole * kBatchEntries));
        EXPECT_EQ((*log)->stats().torn_bytes_dropped > 0, bytes != ends_[whole]);
        EXPECT_TRUE(append_and_wait(**log, session_, whole * kBatchEntries + 1, {"goes on"}));
    }

    TemporaryDirectory directory_;
    SessionId session_ = 0;
    std::vector<std::size_t> ends_; // of the write-ahead log, after the session and each append
};

TEST_F(KilledStore, AMissingWriteAheadLogIsReported) {
    copy_store(killed(), copy());
    fs::remove(only_file_like(copy(), ".log"));
    EXPECT_THAT(open_rocksdb(copy()).error().message, HasSubstr("write-ahead log (*.log) is missing"));
}

/// Removing a session starts a new log. If the server is killed then, that log is empty and stays at the next start.
TEST_F(KilledStore, AMissingWriteAheadLogIsReportedIfAnOlderEmptyOneExists) {
    const auto twice = directory_.path() / "killed twice";
    {
        auto log = open_rocksdb(original()).value();
        log->remove_session(log->create_session("short").value()).value();
        copy_store(original(), killed());
    }
    {
        auto log = open_rocksdb(killed()).value();
        append_and_wait(*log, session_, kBatches * kBatchEntries + 1, {"acknowledged"}).value();
        copy_store(killed(), twice);
    }
    copy_store(twice, copy());
    const auto logs = files_like(copy(), ".log");
    ASSERT_EQ(logs.size(), 2U);
    ASSERT_EQ(fs::file_size(logs.front()), 0U);
    EXPECT_EQ(open_rocksdb(copy()).value()->end_of(session_).value(), kBatches * kBatchEntries + 1);
    copy_store(twice, copy());
    fs::remove(logs.back());
    const auto without = open_rocksdb(copy());
    ASSERT_FALSE(without);
    EXPECT_THAT(without.error().message, HasSubstr("the newest write-ahead log"));
}

TEST_F(KilledStore, AWriteAheadLogCutOffAnywhereOpensWithItsCompleteAppends) {
    std::vector<std::size_t> cuts = {0, 1, ends_.front() - 1};
    for (const std::size_t end : ends_) {
        cuts.insert(cuts.end(), {end, end - 1});
        if (end != ends_.back()) cuts.insert(cuts.end(), {end + 1, end + 7, end + 100});
    }
    std::mt19937 random(1);
    for (int i = 0; i < 10; ++i) cuts.push_back(random() % ends_.back());
    for (const std::size_t cut : cuts) {
        SCOPED_TRACE("cut at " + std::to_string(cut));
        copy_store(killed(), copy());
        fs::resize_file(only_file_like(copy(), ".log"), cut);
        expect_prefix(cut);
    }
}

TEST_F(KilledStore, ALastWriteOfZerosOpensWithoutIt) {
    copy_store(killed(), copy());
    const auto file = only_file_like(copy(), ".log");
    const std::size_t last = ends_[kBatches - 1];
    write_bytes(file, bytes_of(file).substr(0, last + 20) + std::string(ends_.back() - last - 20, '\0'));
    expect_prefix(last + 20);
}

TEST_F(KilledStore, AFlippedBitInTheWriteAheadLogIsReportedAndChangesNothing) {
    std::vector<std::size_t> bytes;
    for (const std::size_t end : ends_) { // every field of a record's header
        if (end != ends_.back()) bytes.insert(bytes.end(), {end, end + 4, end + 5, end + 6, end + 7});
    }
    std::mt19937 random(2);
    for (int i = 0; i < 40; ++i) bytes.push_back(random() % ends_.back());
    for (const std::size_t byte : bytes) {
        SCOPED_TRACE("flipped in byte " + std::to_string(byte));
        copy_store(killed(), copy());
        const auto file = only_file_like(copy(), ".log");
        flip_bit(file, byte, random() % 8);
        const auto log = open_rocksdb(copy());
        ASSERT_FALSE(log);
        EXPECT_EQ(log.error().code, Errc::kStoreFailed);
        EXPECT_THAT(log.error().message, HasSubstr(file.native()));
        EXPECT_EQ(fs::file_size(file), ends_.back());
    }
}

TEST_F(KilledStore, AFlippedBitInAnyByteOfTheManifestIsReported) {
    const auto size = fs::file_size(only_file_like(killed(), "MANIFEST-"));
    std::mt19937 random(3);
    for (std::size_t byte = 0; byte < size; ++byte) {
        SCOPED_TRACE("flipped in byte " + std::to_string(byte));
        copy_store(killed(), copy());
        const auto file = only_file_like(copy(), "MANIFEST-");
        flip_bit(file, byte, random() % 8);
        const auto log = open_rocksdb(copy());
        ASSERT_FALSE(log);
        EXPECT_THAT(log.error().message, HasSubstr(file.native()));
    }
}

TEST_F(KilledStore, AMissingOrDamagedCurrentIsReported) {
    using namespace std::string_literals;
    for (const auto& contents : {""s, "MANIFEST-999999\n"s, "MANIFEST"s, "nonsense\n"s, std::string(16, '\0')}) {
        copy_store(killed(), copy());
        write_bytes(copy() / "CURRENT", contents);
        const auto log = open_rocksdb(copy());
        ASSERT_FALSE(log) << contents;
        EXPECT_THAT(log.error().message, AnyOf(HasSubstr("CURRENT"), HasSubstr("MANIFEST"))) << contents;
        EXPECT_THAT(log.error().message, AllOf(HasSubstr("from a backup"), Not(HasSubstr("\0"s))));
    }
    copy_store(killed(), copy());
    fs::remove(copy() / "CURRENT");
    const auto log = open_rocksdb(copy());
    ASSERT_FALSE(log);
    EXPECT_THAT(log.error().message, HasSubstr("CURRENT is missing"));
}

/// A store whose entries are in table files.
class TableStore : public testing::Test {
protected:
    static constexpr Revision kEntries = 1000;

    TableStore() {
        const auto path = directory_.path() / "original";
        SessionId session = 0;
        {
            auto log = open_rocksdb(path).value();
            session = log->create_session("a session").value();
            append_and_wait(*log, session, 1, distinct_entries(session, 1, kEntries)).value();
            log->write_checkpoint(session, {{"part", "value"}}).value();
        }
        open_rocksdb(path).value(); // recovery moves the write-ahead log's entries into a table
        session_ = session;
        copy_store(path, copy());
    }

    [[nodiscard]] fs::path copy() const { return directory_.path() / "copy"; }
    void restore() const { copy_store(directory_.path() / "original", copy()); }

    /// Opens and reads everything.
    Result<std::vector<std::string>> read_all() {
        auto log = open_rocksdb(copy());
        if (!log) return log.error();
        auto sessions = (*log)->sessions();
        if (!sessions) return sessions.error();
        for (const auto& stored : *sessions) {
            if (!stored.record) return stored.record.error();
            if (stored.damage) return *stored.damage;
        }
        auto checkpoint = checkpoint_of(**log, session_);
        if (!checkpoint) return checkpoint.error();
        EXPECT_EQ(checkpoint->at("part"), "value");
        return entries_after(**log, session_, 0);
    }

    void expect_that_flipped_bits_are_reported_or_harmless(int rounds);

    TemporaryDirectory directory_;
    SessionId session_ = 0;
};

TEST_F(TableStore, ReadsBackEverything) { EXPECT_EQ(read_all().value(), distinct_entries(session_, 1, kEntries)); }

void TableStore::expect_that_flipped_bits_are_reported_or_harmless(int rounds) {
    std::mt19937 random(4);
    int reported = 0;
    for (int round = 0; round < rounds; ++round) {
        restore();
        const auto file = only_file_like(copy(), ".sst");
        flip_bit(file, random() % fs::file_size(file), random() % 8);
        const auto entries = read_all();
        if (entries) {
            EXPECT_EQ(*entries, distinct_entries(session_, 1, kEntries));
            continue;
        }
        ++reported;
        EXPECT_EQ(entries.error().code, Errc::kDataLoss);
        EXPECT_THAT(entries.error().message, HasSubstr(file.filename().native()));
    }
    EXPECT_GE(reported, rounds * 5 / 6) << "nearly all bytes of a table are entries";
}

TEST_F(TableStore, AFlippedBitInATableIsReportedOrHarmless) { expect_that_flipped_bits_are_reported_or_harmless(24); }

class TableStoreTrials : public TableStore {};

TEST_F(TableStoreTrials, AFlippedBitIsReportedOrHarmless) { expect_that_flipped_bits_are_reported_or_harmless(200); }

/// RocksDB by itself accepts no write after a failed merge of tables.
TEST_F(TableStore, ATableThatCannotBeMergedIsReportedAndStopsNoWrite) {
    const auto table = only_file_like(copy(), ".sst");
    flip_bit(table, fs::file_size(table) / 2, 3);
    std::promise<Error> found;
    auto is_found = found.get_future();
    StoreOptions options;
    options.memory_bytes = 512 << 10; // tables of 64 KiB, merged by fours
    options.on_damage = [&found](const Error& damage) { found.set_value(damage); };

    SessionId other = 0;
    Revision end = 0;
    {
        auto log = open_rocksdb(copy(), options).value();
        other = log->create_session("another session").value();
        const auto append = [&] {
            append_and_wait(*log, other, end + 1, distinct_entries(other, end + 1, 20)).value();
            end += 20;
        };
        while (is_found.wait_for(std::chrono::seconds(0)) != std::future_status::ready) append();
        EXPECT_THAT(is_found.get().message, HasSubstr(table.filename().native()));
        EXPECT_THAT(log->stats().damage.value_or(""), HasSubstr(table.filename().native()));
        for (int batch = 0; batch < 100; ++batch) append();
        EXPECT_FALSE(log->stats().last_error);
        EXPECT_THAT(entries_after(*log, session_, 0).error().message, HasSubstr(table.filename().native()));
    }
    options.on_damage = nullptr;
    const auto log = open_rocksdb(copy(), options).value();
    EXPECT_EQ(entries_after(*log, other, 0).value(), distinct_entries(other, 1, end));
    EXPECT_TRUE(append_and_wait(*log, other, end + 1, {"goes on"}));
    EXPECT_TRUE(log->remove_session(session_));
}

TEST_F(TableStore, AMissingOrCutOffTableIsReported) {
    auto file = only_file_like(copy(), ".sst");
    fs::resize_file(file, fs::file_size(file) / 2);
    EXPECT_THAT(read_all().error().message, HasSubstr(file.filename().native()));
    restore();
    fs::remove(file);
    EXPECT_THAT(read_all().error().message, HasSubstr(file.stem().native()));
}

TEST_F(TableStore, CheckTableReadsEveryBlock) {
    const auto table = only_file_like(copy(), ".sst");
    EXPECT_TRUE(check_table(table));
    const auto size = fs::file_size(table);
    for (std::size_t byte = 0; byte < size; byte += 1 + size / 50) {
        restore();
        flip_bit(table, byte, 5);
        const auto checked = check_table(table);
        ASSERT_FALSE(checked) << "flipped in byte " << byte;
        EXPECT_THAT(checked.error().message, HasSubstr(table.native()));
    }
}

/// RocksDB by itself takes a length beyond the end of the file for the end of the manifest, and ignores the last
/// tables.
TEST_F(TableStore, AManifestRecordWithAGreaterLengthIsReported) {
    const auto size = fs::file_size(only_file_like(copy(), "MANIFEST-"));
    for (std::size_t byte = 0; byte < size; ++byte) {
        restore();
        const auto file = only_file_like(copy(), "MANIFEST-");
        flip_bit(file, byte, 7);
        const auto log = open_rocksdb(copy());
        ASSERT_FALSE(log) << "flipped in byte " << byte;
        EXPECT_THAT(log.error().message, HasSubstr(file.native()));
    }
}

TEST_F(TableStore, AnEmptyManifestIsReportedAndRemovesNoTable) {
    for (const std::string& contents : {std::string(), std::string(100, '\0')}) {
        restore();
        const auto file = only_file_like(copy(), "MANIFEST-");
        const auto table = only_file_like(copy(), ".sst");
        write_bytes(file, contents);
        EXPECT_THAT(read_all().error().message, AllOf(HasSubstr(file.native()), HasSubstr("from a backup")));
        EXPECT_TRUE(fs::exists(table));
    }
}

} // namespace
} // namespace scanloom::store
