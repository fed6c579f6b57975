#include "tests/unit/server/sessions/session_fixture.hpp"

#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

/// Each submitted scan is counted once: applied, duplicate or dropped.
class ScanCounters : public SessionTest {
protected:
    void submit(const std::shared_ptr<RecordedLink>& link, std::vector<Scan> scans) {
        submitted_ += scans.size();
        session_->submit(link, std::move(scans), 10);
    }

    void expect(std::uint64_t applied, std::uint64_t duplicates, std::uint64_t dropped) const {
        EXPECT_EQ(counters_->scans_applied, applied);
        EXPECT_EQ(counters_->scans_duplicates, duplicates);
        EXPECT_EQ(counters_->scans_dropped, dropped);
        EXPECT_EQ(submitted_, applied + duplicates + dropped);
    }

    std::uint64_t submitted_ = 0;
};

TEST_F(ScanCounters, ScansOfAReplacedLinkAreDroppedAndAcceptedAgainLater) {
    const auto cut = join("r");
    submit(cut, random_scans(1, 1, 10));
    run();
    const auto link = join("r");
    submit(cut, random_scans(1, 11, 5)); // these scans were not yet read when the robot reconnected
    run();
    expect(10, 0, 5);
    submit(link, random_scans(1, 11, 5));
    run();
    expect(15, 0, 5);
}

TEST_F(ScanCounters, ScansDuringClosingAreDropped) {
    const auto link = join("r");
    submit(link, random_scans(1, 1, 3));
    session_->close({Errc::kShuttingDown, "bye"}, [] {});
    submit(link, random_scans(1, 4, 4));
    run();
    expect(3, 0, 4);
}

TEST_F(ScanCounters, ScansThatTheDiskRefusedAreDropped) {
    const auto link = join("r");
    log_.hold_completions();
    submit(link, random_scans(1, 1, 3));
    run();
    submit(link, random_scans(1, 4, 4)); // waits for the disk
    run();
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    log_.release_completions();
    run();
    EXPECT_EQ(link->failures.size(), 1U);
    const std::uint64_t applied = counters_->scans_applied;
    expect(applied, 0, 7 - applied);
    EXPECT_GE(counters_->scans_dropped, 4U);
}

TEST_F(ScanCounters, ScansThatAFullMapRefusedAreDropped) {
    limits_.chunks_max = 40; // a scan of small_laser() may need 16 chunks
    start_session();
    const auto link = join("r");
    std::vector<Scan> far_apart = random_scans(1, 1, 20);
    for (auto& scan : far_apart) scan.pose = {10.0 * static_cast<double>(scan.seq), 0.0, 0.0};
    submit(link, std::move(far_apart));
    run();
    ASSERT_EQ(link->failures.size(), 1U);
    EXPECT_EQ(link->failures[0].code, Errc::kFull);
    const std::uint64_t applied = counters_->scans_applied;
    EXPECT_GT(applied, 0U);
    EXPECT_LT(applied, 20U);
    expect(applied, 0, 20 - applied);
}

TEST_F(ScanCounters, CountsSurviveARestart) {
    submit(join("r"), random_scans(1, 1, 10));
    run();
    session_.reset();
    start_session();
    expect(10, 0, 0);
}

} // namespace
} // namespace scanloom::sessions
