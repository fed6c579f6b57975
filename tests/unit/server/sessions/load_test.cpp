#include "tests/unit/server/sessions/session_fixture.hpp"

/// Expensive scans, and full maps.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A laser with a range of 70 m in all directions: at a resolution of 2 cm, one scan takes more work than a slice.
Sensor far_laser() {
    Sensor sensor = small_laser();
    sensor.angles = UniformAngles{0.0, std::numbers::pi / 9, 18};
    sensor.range_max = 70.0;
    return sensor;
}

std::vector<Scan> far_scans(std::uint64_t first_seq, std::size_t count) {
    auto scans = random_scans(1, first_seq, count);
    for (auto& scan : scans) scan.ranges.assign(18, 69'000);
    return scans;
}

class HeavySessionTest : public SessionTest {
protected:
    void SetUp() override {
        config_ = *mapping::resolve({.cell_size = 0.02, .beam_aperture = 0.349});
        SessionTest::SetUp();
        link_ = join("r", false);
        session_->submit(link_, far_laser(), 0);
        run();
    }

    void run_until(const std::function<bool()>& reached) {
        compute_.restart();
        while (!reached() && compute_.run_one() > 0) {
        }
        ASSERT_TRUE(reached());
    }

    std::shared_ptr<RecordedLink> link_;
};

TEST_F(HeavySessionTest, OtherSessionsRunBetweenScans) {
    session_->submit(link_, far_scans(1, 5), 10);
    run_until([&] { return session_->is_connected(0) && log_.stats().entries == 7; });
    bool answered = false;
    boost::asio::post(compute_, [&] { answered = true; }); // work of another session
    run_until([&] { return answered; });
    EXPECT_LT(link_->durable_seq(), 5U) << "the other session waited for all scans";
    run();
    EXPECT_EQ(link_->durable_seq(), 5U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(HeavySessionTest, OtherSessionsRunWithinAScan) {
    session_->submit(link_, far_scans(1, 1), 10);
    run_until([&] { return log_.stats().entries == 3; });
    int turns = 0;
    while (link_->durable_seq() == 0) {
        bool answered = false;
        boost::asio::post(compute_, [&] { answered = true; }); // work of another session
        run_until([&] { return answered; });
        ++turns;
    }
    EXPECT_GE(turns, 3);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(HeavySessionTest, OwnRobotsAreServedBetweenScans) {
    session_->submit(link_, far_scans(1, 5), 10);
    run_until([&] { return log_.stats().entries == 7; });
    bool joined = false; // one group later
    session_->join({"r2"}, std::make_shared<RecordedLink>(), [&](const Result<Joined>& answer) { joined = !!answer; });
    session_->leave(link_);
    run_until([&] { return !session_->is_connected(0); });
    EXPECT_LT(session_->snapshot()->robots[0].last_seq, 5U);
    run();
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 5U) << "submitted scans are kept";
    EXPECT_TRUE(joined);
}

TEST_F(HeavySessionTest, HurryEndsClosingAndARestartIntegratesTheRest) {
    log_.hold_completions();
    session_->submit(link_, far_scans(1, 4), 10);
    session_->submit(link_, far_scans(5, 3), 10);
    run();
    bool closed = false;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { closed = true; });
    session_->finish_early();
    log_.release_completions();
    run();
    EXPECT_TRUE(closed);
    EXPECT_THAT(link_->failures, SizeIs(1));
    EXPECT_EQ(link_->durable_seq(), 4U) << "durable scans are acknowledged even if they are not integrated";
    start_session();
    EXPECT_EQ(last_durable_seq_on_joining("r"), 4U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(HeavySessionTest, HurryBeforeClosingStaysInEffect) {
    session_->submit(link_, far_scans(1, 5), 10);
    run_until([&] { return log_.stats().entries == 7; });
    session_->finish_early();
    run();
    bool closed = false;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { closed = true; });
    run();
    EXPECT_TRUE(closed);
    EXPECT_THAT(link_->failures, SizeIs(1));
    EXPECT_EQ(link_->durable_seq(), 5U);
    EXPECT_LT(session_->snapshot()->robots[0].last_seq, 5U) << "no more scans are integrated after finish_early()";
    start_session();
    EXPECT_EQ(last_durable_seq_on_joining("r"), 5U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(HeavySessionTest, HurryWithinAGroupLeavesTheRestToTheNextStart) {
    session_->submit(link_, far_scans(1, 5), 10);
    run_until([&] { return log_.stats().entries == 7; });
    compute_.run_one(); // the group is durable and its first slice is integrated
    bool closed = false;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { closed = true; });
    session_->finish_early();
    run();
    EXPECT_TRUE(closed);
    EXPECT_EQ(session_->snapshot()->revision, 2U) << "no partly integrated scan is visible";
    EXPECT_THAT(store::checkpoint_of(log_, id_).value(), IsEmpty()) << "writing a checkpoint takes too long";
    start_session();
    EXPECT_EQ(last_durable_seq_on_joining("r"), 5U);
    EXPECT_EQ(digest(), digest_of_log());
}

/// A session whose map is limited to a few chunks.
class SmallMapTest : public SessionTest {
protected:
    void SetUp() override {
        limits_.chunks_max = 40; // a scan of small_laser() may need 16 chunks
        SessionTest::SetUp();
        link_ = join("r");
    }

    /// Returns a scan around (x, 0).
    static Scan scan_at(std::uint64_t seq, double x) {
        Scan scan = random_scan(1, seq);
        scan.pose = {x, 0.0, 0.0};
        return scan;
    }

    std::shared_ptr<RecordedLink> link_;
};

TEST_F(SmallMapTest, ScanThatMayExceedTheMapIsRefused) {
    std::uint64_t seq = 0;
    while (link_->failures.empty()) {
        ++seq;
        session_->submit(link_, {scan_at(seq, 10.0 * static_cast<double>(seq))}, 10);
        run();
    }
    EXPECT_EQ(link_->failures[0].code, Errc::kFull);
    EXPECT_THAT(link_->failures[0].message, HasSubstr("a scan could take it beyond 40"));
    EXPECT_GE(seq, 3U);
    EXPECT_EQ(link_->durable_seq(), seq - 1);
    EXPECT_THAT(logged(), SizeIs(2 + seq - 1)) << "scans that are not integrated are not in the log";
    EXPECT_EQ(digest(), digest_of_log());

    const auto again = begin_join("r");
    EXPECT_EQ(again.answer->value().value().last_durable_seq, seq - 1);
    session_->submit(again.link, {scan_at(seq, 10.0)}, 10); // in an explored part of the map
    run();
    EXPECT_THAT(again.link->failures, SizeIs(1)) << "the scan might need new chunks";
    EXPECT_FALSE(session_->is_connected(0));
}

TEST_F(SmallMapTest, ManyScansOfOnePlaceAreAccepted) {
    std::vector<Scan> scans;
    for (std::uint64_t seq = 1; seq <= 700; ++seq) scans.push_back(scan_at(seq, 0.0));
    session_->submit(link_, scans, 10);
    run();
    EXPECT_EQ(link_->durable_seq(), 700U);
    EXPECT_THAT(link_->failures, IsEmpty());
}

TEST_F(SmallMapTest, RefusedRobotDoesNotAffectOthers) {
    const auto other = join("other");
    log_.hold_completions();
    session_->submit(other, {random_scan(1, 1)}, 10);
    run();
    std::vector<Scan> scans;
    for (std::uint64_t seq = 1; seq <= 6; ++seq) scans.push_back(scan_at(seq, 100.0 * static_cast<double>(seq)));
    session_->submit(link_, scans, 10);
    Scan near = random_scan(1, 2);
    near.ranges.assign(18, 100);
    session_->submit(other, {near}, 10);
    log_.release_completions();
    run();
    EXPECT_THAT(link_->failures, SizeIs(1));
    EXPECT_EQ(other->durable_seq(), 2U);
    EXPECT_THAT(other->failures, IsEmpty());
    EXPECT_EQ(digest(), digest_of_log());
}

} // namespace
} // namespace scanloom::sessions
