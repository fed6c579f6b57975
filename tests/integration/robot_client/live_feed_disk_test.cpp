#include "tests/integration/robot_client/live_feed_fixture.hpp"

#include <sys/resource.h>

#include <csignal>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Limits the size of files while this object exists, as if the disk were full.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit full{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &full);
    }
    ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

TEST_F(LiveFeedTest, ScansThatBypassedAFullDiskDoNotBlockTheNextProgram) {
    LinkScript silent;
    silent.ack_every = 1000;
    server_.continue_with(silent);
    std::optional<FullDisk> full;
    ScriptedSource source;
    server_.on_stored = [&](std::size_t stored) {
        if (stored == 10) {
            full.emplace(300);
            source.allow(30);
        }
        if (stored == 30) kill();
    };
    source.allow(10);
    EXPECT_FALSE(run(source, spool()));
    full.reset();
    server_.continue_with({});
    ScriptedSource next;
    next.given_ = 30;
    next.allow(35);
    next.end();
    const auto outcome = run(next, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(35);
}

TEST_F(LiveFeedTest, ADiskThatIsFullFromTheStartBlocksNothing) {
    FullDisk full(0);
    ScriptedSource source;
    source.allow(100);
    source.end();
    const auto outcome = run(source, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(100);
    EXPECT_THAT(warnings_, testing::ElementsAre(HasSubstr("File too large; scans are held in memory only")));
}

TEST_F(LiveFeedTest, ADiskThatIsFullBeforeTheFirstScanBlocksNothing) {
    FullDisk full(0);
    ScriptedSource source;
    const std::function<void()> begin_once_warned = [&] {
        if (warnings_.empty()) return asio::post(uplink_->executor(), begin_once_warned);
        source.allow(100);
        source.end();
    };
    const auto outcome = run(source, spool(), begin_once_warned);
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(100);
    EXPECT_THAT(warnings_, testing::ElementsAre(HasSubstr("File too large; scans are held in memory only")));
}

TEST_F(LiveFeedTest, UnspooledScansDoNotOvertakeSpooledOnes) {
    server_.close();
    std::optional<FullDisk> full;
    ScriptedSource source;
    source.on_given = [&](std::uint64_t given) {
        if (given == 21) full.emplace(300);
        if (given != 30) return;
        server_.reopen();
        source.end();
    };
    source.allow(30);
    const auto outcome = run(source, spool());
    full.reset();
    EXPECT_TRUE(outcome) << outcome.error().message;
    ASSERT_GE(server_.stored().size(), 20U);
    for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(server_.stored()[i].pose->x, static_cast<double>(i + 1));
    EXPECT_EQ(status_.dropped, 30 - server_.stored().size());
    EXPECT_GT(status_.dropped, 5U);
    EXPECT_THAT(server_.faults(), IsEmpty());
}

TEST_F(LiveFeedTest, TheSpoolIsSentAlsoOnAFullDisk) {
    server_.close();
    {
        ScriptedSource source;
        source.on_given = [&](std::uint64_t given) {
            if (given == 600) kill();
        };
        source.allow(600);
        EXPECT_FALSE(run(source, spool()));
    }
    FullDisk full(300); // files cannot grow; existing bytes can be changed
    server_.reopen();
    ScriptedSource next;
    next.end();
    const auto outcome = run(next, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(599);
}

TEST_F(LiveFeedTest, AnUnwritableSpoolIsReportedAndTheLinkContinues) {
    std::optional<FullDisk> full;
    ScriptedSource source;
    server_.on_stored = [&](std::size_t stored) {
        if (stored != 10) return;
        full.emplace(300);
        source.allow(100);
        source.end();
    };
    source.allow(10);
    const auto outcome = run(source, spool());
    full.reset();
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(100);
    EXPECT_THAT(warnings_, testing::ElementsAre(HasSubstr("File too large; scans are held in memory only")));
}

} // namespace
} // namespace scanloom::robot
