#include "server/store/scan_log.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <charconv>
#include <thread>

/// Disks that fill up, fail to sync, and lose power.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

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
        EXPECT_THAT(appended.error().message, HasSubstr("until the server is restarted"));
    }
    EXPECT_FALSE(log->create_session("b"));
    EXPECT_FALSE(log->write_checkpoint(session, {{"k", "v"}}));
    EXPECT_FALSE(log->remove_session(session));
    EXPECT_THAT(log->stats().last_error.value_or(""), HasSubstr("Input/output error"));
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable")) << "reading goes on";
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

/// One session written as fast as it goes, with checkpoints that run ahead of the acknowledgements.
class Writer {
public:
    explicit Writer(ScanLog& log) : log_(log), session(log.create_session("s").value()) {}

    void run(const std::atomic<bool>& stop) {
        Revision next = 1;
        for (int step = 0; !stop && step < 100'000; ++step) {
            const std::size_t count = 1 + next % 7;
            const Revision last = next + count - 1;
            log_.append(session, next, distinct_entries(session, next, count), [this, last](Result<> result) {
                EXPECT_TRUE(result);
                acknowledged = last;
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

TEST_F(FaultyDisk, APowerCutLosesNothingAcknowledgedAndNoCheckpointIsAheadOfItsLog) {
    constexpr int kCuts = 25;
    options_.memory_bytes = 1 << 20; // tables and compactions all the time
    std::mt19937 random(9);
    const auto log = open_rocksdb(directory_, options_).value();
    Writer one(*log);
    Writer two(*log);
    std::atomic<bool> stop = false;
    std::jthread thread_one([&] { one.run(stop); });
    std::jthread thread_two([&] { two.run(stop); });
    for (int cut = 0; cut < kCuts; ++cut) {
        SCOPED_TRACE("cut " + std::to_string(cut));
        const auto appends = log->stats().appends;
        while (log->stats().appends < appends + random() % 50) std::this_thread::yield();
        const std::pair<Writer*, Revision> seen[] = {{&one, one.acknowledged}, {&two, two.acknowledged}};
        const std::pair<Writer*, Revision> written[] = {{&one, one.checkpointed}, {&two, two.checkpointed}};
        const fs::path picture = temporary_.path() / ("cut" + std::to_string(cut));
        disk_.files->picture_of_power_cut(directory_, picture, random);

        auto recovered = open_rocksdb(picture);
        EXPECT_TRUE(recovered) << recovered.error().message;
        if (!recovered) break;
        for (std::size_t i = 0; i < 2; ++i) {
            const auto& [writer, acknowledged] = seen[i];
            const auto entries = entries_after(**recovered, writer->session, 0).value();
            EXPECT_GE(entries.size(), acknowledged);
            EXPECT_EQ(entries, distinct_entries(writer->session, 1, entries.size()));
            auto checkpoint = checkpoint_of(**recovered, writer->session).value();
            EXPECT_LE(revision_in(checkpoint["a"]), entries.size());
            EXPECT_GE(revision_in(checkpoint["a"]), written[i].second);
            EXPECT_EQ(revision_in(checkpoint["a"]), revision_in(checkpoint["b"])) << "all parts or none";
        }
        recovered->reset();
        fs::remove_all(picture);
    }
    stop = true;
}

} // namespace
} // namespace scanloom::store
