#include "tests/fault/simulation/story.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <algorithm>

namespace scanloom::simulation {
namespace {

class SimulationTest : public testing::Test {
protected:
    void SetUp() override { spdlog::set_level(spdlog::level::off); }
};

/// Returns whether one of the first seeds detects the fault.
bool is_found_out(Story story) {
    constexpr std::uint64_t kSeeds = 50;
    for (story.seed = 1; story.seed <= kSeeds; ++story.seed) {
        if (!tell(story).outcome.passed()) return true;
    }
    return false;
}

TEST_F(SimulationTest, EqualSeedsGiveEqualRuns) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const auto first = tell({.seed = seed});
        const auto again = tell({.seed = seed});
        EXPECT_EQ(first.fingerprint, again.fingerprint) << "seed " << seed;
        EXPECT_EQ(first.outcome.figures, again.outcome.figures) << "seed " << seed;
    }
}

/// The row "simulation" runs more of them.
TEST_F(SimulationTest, AcknowledgedScansAreKeptInEveryRun) {
    fault::Outcome all;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const auto ending = tell({.seed = seed});
        EXPECT_TRUE(ending.outcome.passed())
            << "seed " << seed << ": " << testing::PrintToString(ending.outcome.failures);
        all.add(ending.outcome);
    }
    for (const auto* refusal :
         {"ended_full", "ended_too_large", "ended_unauthorized", "refused_limit", "refused_no_token", "refused_revoked",
          "refused_too_many_links", "refused_unknown_token", "refused_without_hello", "refused_wrong_role",
          "refused_wrong_session"})
        EXPECT_GT(all.figures[refusal], 0U) << "never tried: " << refusal;
}

TEST_F(SimulationTest, DifferentSeedsGiveDifferentRuns) {
    EXPECT_NE(tell({.seed = 1}).fingerprint, tell({.seed = 2}).fingerprint);
}

/// Independent of later events: a robot that starts again may send the scans once more.
TEST_F(SimulationTest, DroppedAcknowledgedScansAreDetected) {
    std::uint64_t with_broken_promises = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const auto ending = tell({.seed = seed, .hasty_disk = true});
        if (ending.broken == 0) continue;
        ++with_broken_promises;
        EXPECT_FALSE(ending.outcome.passed())
            << ending.broken << " dropped scans of seed " << seed << " are not missed";
    }
    EXPECT_GT(with_broken_promises, 50U) << "nothing was tried";
}

TEST_F(SimulationTest, DuplicateStorageIsDetected) { EXPECT_TRUE(is_found_out({.forgetful_disk = true})); }

} // namespace
} // namespace scanloom::simulation
