#include "server/store/rocksdb_store.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <charconv>
#include <thread>
#include <utility>
#include <vector>

/// Disks that fill up, fail to sync, and lose power.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class FaultyDisk : public testing::Test {
protected:
    FaultyDisk() { options_.env = disk_.env.get(); }

    TemporaryDirectory temporary_;
    fs::path directory_ = temporary_.path() / "store";
    FaultyEnv disk_;
    StoreOptions options_;
};

TEST_F(FaultyDisk, AfterAFailedSyncNothingIsAcknowledgedUntilReopened) {
    auto log = open_rocksdb(directory_, options_).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    disk_.files->fail_next_log_sync();
    for (int attempt = 0; attempt < 3; ++attempt) {
        const auto appended = append_and_wait(*log, session, 2, {"lost"});
        ASSERT_FALSE(appended) << "only the first sync fails, but no later one can be trusted";
        EXPECT_EQ(appended.error().code, Errc::kStoreFailed);
        EXPECT_THAT(appended.error().message, HasSubstr("until it is reopened"));
    }
    EXPECT_FALSE(log->create_session("b"));
    EXPECT_FALSE(log->write_checkpoint(session, {{"k", "v"}}));
    EXPECT_FALSE(log->remove_session(session));
    EXPECT_THAT(log->stats().last_error.value_or(""), HasSubstr("Input/output error"));
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable")) << "reading continues";
    log.reset();

    log = open_rocksdb(directory_, options_).value();
    const Revision end = entries_after(*log, session, 0).value().size();
    EXPECT_GE(end, 1U);
    EXPECT_TRUE(append_and_wait(*log, session, end + 1, {"goes on"}));
}

TEST_F(FaultyDisk, AFullDiskFailsAppendsAndLosesNothing) {
    auto log = open_rocksdb(directory_, options_).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    disk_.files->set_disk_full(true);
    const auto appended = append_and_wait(*log, session, 2, {"lost"});
    ASSERT_FALSE(appended);
    EXPECT_THAT(appended.error().message, HasSubstr("No space left"));
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable"));
    log.reset();
    EXPECT_THAT(open_rocksdb(directory_, options_).error().message, HasSubstr("the disk is full"));

    disk_.files->set_disk_full(false);
    log = open_rocksdb(directory_, options_).value();
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable"));
    EXPECT_TRUE(append_and_wait(*log, session, 2, {"goes on"}));
}

TEST_F(FaultyDisk, WithoutRoomOnlyRemovalsAreAcceptedUntilThereIsRoom) {
    options_.disk_reserve_bytes = 1000;
    disk_.files->set_free_bytes(1000);
    auto log = open_rocksdb(directory_, options_).value();
    const auto session = log->create_session("a").value();
    const auto other = log->create_session("b").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    disk_.files->set_free_bytes(999);
    for (int attempt = 0; attempt < 2; ++attempt) {
        const auto appended = append_and_wait(*log, session, 2, {"later"});
        ASSERT_FALSE(appended);
        EXPECT_EQ(appended.error().code, Errc::kOverloaded);
        EXPECT_THAT(appended.error().message, HasSubstr("kept free"));
    }
    EXPECT_EQ(log->create_session("c").error().code, Errc::kOverloaded);
    EXPECT_EQ(log->write_checkpoint(session, {{"k", "v"}}).error().code, Errc::kOverloaded);
    EXPECT_TRUE(log->stats().no_room);
    EXPECT_FALSE(log->stats().last_error);
    EXPECT_TRUE(log->remove_session(other));
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable"));

    disk_.files->set_free_bytes(1000);
    EXPECT_FALSE(log->stats().no_room) << "even before the next append";
    EXPECT_TRUE(append_and_wait(*log, session, 2, {"later"}));
}

TEST_F(FaultyDisk, AFailedLogIsReopenedOnceItsDiskCanBeWritten) {
    const auto log = open_rocksdb(directory_, options_).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    EXPECT_FALSE(log->reopen()) << "it has not failed";
    const auto before = log->stats();
    disk_.files->fail_next_log_sync();
    ASSERT_FALSE(append_and_wait(*log, session, 2, {"perhaps"}));
    disk_.files->set_disk_full(true);
    EXPECT_FALSE(log->reopen()) << "the disk cannot be written";
    disk_.files->set_disk_full(false);
    disk_.files->set_free_bytes(1000);
    EXPECT_FALSE(log->reopen()) << "the disk has no room";
    disk_.files->set_free_bytes(std::nullopt);
    EXPECT_TRUE(log->stats().last_error);
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable")) << "reading continues";
    ASSERT_TRUE(log->reopen());
    EXPECT_FALSE(log->stats().last_error);
    EXPECT_EQ(log->stats().entries, before.entries) << "statistics cover all openings";
    const Revision end = log->end_of(session).value();
    EXPECT_EQ(entries_after(*log, session, 0).value()[0], "durable");
    EXPECT_TRUE(append_and_wait(*log, session, end + 1, {"goes on"}));
    EXPECT_EQ(log->stats().entries, before.entries + 1);
}

TEST_F(FaultyDisk, ALogThatCannotBeReopenedFailsUntilItCan) {
    const auto log = open_rocksdb(directory_, options_).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    disk_.files->fail_next_log_sync();
    ASSERT_FALSE(append_and_wait(*log, session, 2, {"perhaps"}));
    const auto manifest = only_file_like(directory_, "MANIFEST-");
    flip_bit(manifest, 40, 1);
    EXPECT_FALSE(log->reopen());
    EXPECT_THAT(log->stats().last_error.value_or(""), HasSubstr(manifest.native()));
    EXPECT_EQ(append_and_wait(*log, session, 2, {"lost"}).error().code, Errc::kStoreFailed);
    EXPECT_THAT(log->end_of(session).error().message, HasSubstr("is being reopened: " + manifest.native()));
    flip_bit(manifest, 40, 1);
    ASSERT_TRUE(log->reopen());
    EXPECT_TRUE(append_and_wait(*log, session, log->end_of(session).value() + 1, {"goes on"}));
}

TEST_F(FaultyDisk, LogsThatCannotBeReadAreReported) {
    std::vector<std::pair<SessionId, Errc>> reported;
    options_.on_unreadable = [&](SessionId session, const Error& why) { reported.emplace_back(session, why.code); };
    SessionId session = 0;
    {
        const auto log = open_rocksdb(directory_, options_).value();
        session = log->create_session("a").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, distinct_entries(session, 1, 100)));
    }
    { ASSERT_TRUE(open_rocksdb(directory_, options_)); } // moves the entries to a table
    const auto log = open_rocksdb(directory_, options_).value();
    EXPECT_TRUE(entries_after(*log, session, 0));
    const Error of_the_reader{Errc::kMalformed, "enough"};
    EXPECT_EQ(log->read(session, 0, [&](Revision, std::string_view) -> Result<> { return of_the_reader; }).error(),
              of_the_reader);
    EXPECT_FALSE(entries_after(*log, 99, 0));
    EXPECT_THAT(reported, IsEmpty());
    const auto table = files_like(directory_, ".sst").front();
    flip_bit(table, fs::file_size(table) / 2, 1);
    EXPECT_FALSE(entries_after(*log, session, 0));
    EXPECT_THAT(reported, ElementsAre(std::pair(session, Errc::kDataLoss)));
}

/// Writes one session as fast as possible, with checkpoints ahead of the acknowledgements.
class Writer {
public:
    explicit Writer(ScanLog& log) : log_(log), session(log.create_session("s").value()) {}

    void run(const std::atomic<bool>& stop) {
        Revision next = 1;
        for (int step = 0; !stop; ++step) {
            const std::size_t count = 1 + next % 7;
            const Revision last = next + count - 1;
            log_.append(session, next, distinct_entries(session, next, count), [this, last](Result<> result) {
                EXPECT_TRUE(result);
                acknowledged = last;
                acknowledged.notify_all();
            });
            next += count;
            if (step % 10 == 9) {
                const std::string revision = std::to_string(last);
                EXPECT_TRUE(log_.write_checkpoint(
                    session, {{"a", revision + ":" + std::string(step % 100 * 200, 'x')}, {"b", revision + ":"}}));
                checkpointed = last;
            }
        }
    }

private:
    ScanLog& log_;

public:
    const SessionId session;
    std::atomic<Revision> acknowledged = 0;
    std::atomic<Revision> checkpointed = 0;
};

Revision revision_in(const std::string& part) {
    Revision revision = 0;
    std::from_chars(part.data(), part.data() + part.size(), revision);
    return revision;
}

/// The state that must be found after one power cut.
struct PowerCut {
    struct Session {
        SessionId id;
        Revision acknowledged;
        Revision checkpointed;
    };
    fs::path picture;
    std::vector<Session> sessions;
};

void expect_recovered(const PowerCut& cut) {
    const auto log = open_rocksdb(cut.picture);
    ASSERT_TRUE(log) << log.error().message;
    for (const auto& session : cut.sessions) {
        const auto entries = entries_after(**log, session.id, 0).value();
        EXPECT_GE(entries.size(), session.acknowledged);
        EXPECT_EQ(entries, distinct_entries(session.id, 1, entries.size()));
        auto checkpoint = checkpoint_of(**log, session.id).value();
        EXPECT_LE(revision_in(checkpoint["a"]), entries.size()) << "a checkpoint ahead of its log";
        EXPECT_GE(revision_in(checkpoint["a"]), session.checkpointed);
        EXPECT_EQ(revision_in(checkpoint["a"]), revision_in(checkpoint["b"])) << "all parts or none";
    }
}

TEST_F(FaultyDisk, APowerCutLosesNothingAcknowledgedAndNoCheckpointIsAheadOfItsLog) {
    constexpr std::size_t kCuts = 25;
    options_.memory_bytes = 1 << 20; // tables and compactions all the time
    std::mt19937 random(9);
    std::vector<PowerCut> cuts;
    {
        const auto log = open_rocksdb(directory_, options_).value();
        Writer one(*log);
        Writer two(*log);
        std::atomic<bool> stop = false;
        std::jthread thread_one([&] { one.run(stop); });
        std::jthread thread_two([&] { two.run(stop); });
        while (cuts.size() < kCuts) {
            const Revision next_cut = one.acknowledged + random() % 100;
            while (one.acknowledged < next_cut) one.acknowledged.wait(one.acknowledged);
            PowerCut cut{temporary_.path() / ("cut" + std::to_string(cuts.size())), {}};
            for (const auto* writer : {&one, &two}) {
                cut.sessions.push_back({writer->session, writer->acknowledged, writer->checkpointed});
            }
            disk_.files->picture_of_power_cut(directory_, cut.picture, random);
            cuts.push_back(std::move(cut));
        }
        stop = true;
    }
    for (const PowerCut& cut : cuts) {
        SCOPED_TRACE(cut.picture.filename());
        expect_recovered(cut);
    }
}

} // namespace
} // namespace scanloom::store
