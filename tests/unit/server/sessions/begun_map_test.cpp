#include "tests/unit/server/sessions/session_fixture.hpp"

#include <algorithm>

/// Robots that were allowed to begin the map of an empty session.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Scan beginning(unsigned seed) {
    Scan scan = random_scan(seed, 1);
    scan.begins_map = true;
    return scan;
}

class BegunMapTest : public SessionTest {
protected:
    [[nodiscard]] std::size_t scans_logged() {
        const auto entries = logged();
        return static_cast<std::size_t>(std::ranges::count_if(
            entries, [](const LogEntry& entry) { return std::holds_alternative<ScanTaken>(entry); }));
    }

    static void expect_refused(const RecordedLink& link) {
        ASSERT_THAT(link.failures, SizeIs(1));
        EXPECT_EQ(link.failures[0].code, Errc::kConflict);
        EXPECT_THAT(link.failures[0].message,
                    HasSubstr("scan_batch.scans[0].begins_map: robot 'late' was to begin the map of session 'lab'"));
        EXPECT_EQ(link.durable_seq(), 0U);
    }
};

TEST_F(BegunMapTest, RefusesASecondBeginningWhileTheFirstIsPending) {
    const auto first = join("first");
    const auto late = join("late");
    session_->submit(first, {beginning(1)}, 0);
    session_->submit(late, {beginning(2)}, 0);
    run();
    EXPECT_EQ(first->durable_seq(), 1U);
    expect_refused(*late);
}

TEST_F(BegunMapTest, RefusesABeginningAfterAScanWithKnownPose) {
    const auto first = join("first");
    const auto late = join("late");
    session_->submit(first, {random_scan(1, 1)}, 0);
    session_->submit(late, {beginning(2)}, 0);
    run();
    expect_refused(*late);
}

TEST_F(BegunMapTest, RefusesABeginningAfterARestart) {
    session_->submit(join("first"), {beginning(1)}, 0);
    run();
    start_session();
    const auto late = join("late");
    session_->submit(late, {beginning(2)}, 0);
    run();
    expect_refused(*late);
}

TEST_F(BegunMapTest, FirstRobotMayResendItsBeginning) {
    session_->submit(join("first"), {beginning(1)}, 0);
    run();
    const auto again = join("first");
    session_->submit(again, {beginning(1), random_scan(1, 2)}, 0);
    run();
    EXPECT_THAT(again->failures, IsEmpty());
    EXPECT_EQ(again->durable_seq(), 2U);
}

TEST_F(BegunMapTest, AcceptsABeginningAfterAScanWithoutReadings) {
    const auto blind = join("blind");
    const auto late = join("late");
    Scan nothing = random_scan(1, 1);
    std::ranges::fill(nothing.ranges, kInvalidRange);
    session_->submit(blind, {nothing}, 0);
    session_->submit(late, {beginning(2)}, 0);
    run();
    EXPECT_THAT(late->failures, IsEmpty());
    EXPECT_EQ(late->durable_seq(), 1U);
}

TEST_F(BegunMapTest, AcceptsABeginningAfterALostScan) {
    const auto first = join("first");
    log_.refuse_appends(1);
    session_->submit(first, {beginning(1)}, 0);
    run();
    ASSERT_THAT(first->failures, SizeIs(1));
    const auto late = join("late");
    session_->submit(late, {beginning(2)}, 0);
    run();
    EXPECT_EQ(late->durable_seq(), 1U);
}

} // namespace
} // namespace scanloom::sessions
