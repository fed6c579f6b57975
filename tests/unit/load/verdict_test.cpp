#include "load/core/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::load {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const ExpectedSession kExpected{"load-1-3", {{"r0", 300}, {"r1", 200}}};
const FoundSession kFound{500, 504, {{"r0", 300, 300}, {"r1", 200, 200}}, 0};

std::string contradiction_in(const FoundSession& found) { return contradiction(kExpected, found).value_or("nothing"); }

TEST(Contradiction, IsAbsentIfEachScanIsStoredOnce) { EXPECT_EQ(contradiction_in(kFound), "nothing"); }

TEST(Contradiction, EveryDifferenceOfASessionIsFound) {
    auto found = kFound;
    found.robots[1].scans = 199;
    EXPECT_EQ(contradiction_in(found),
              "session load-1-3 has 199 scans of robot r1, the newest with seq 200; 200 were acknowledged");
    found = kFound;
    found.robots[0].last_seq = 299;
    EXPECT_THAT(contradiction_in(found), HasSubstr("seq 299; 300 were acknowledged"));
    found = kFound;
    found.robots[0].name = "r7";
    EXPECT_THAT(contradiction_in(found), HasSubstr("has no robot r0"));
    found = kFound;
    found.robots.push_back({"r9", 0, 0});
    EXPECT_THAT(contradiction_in(found), HasSubstr("has 3 robots; 2 streamed into it"));
    found = kFound;
    found.scans = 501;
    EXPECT_THAT(contradiction_in(found), HasSubstr("has 501 scans; 500 were acknowledged"));
    found = kFound;
    found.revision = 505;
    EXPECT_THAT(contradiction_in(found), HasSubstr("at revision 505; its scans and robots need 504 entries"));
}

TEST(Contradiction, CorrectionsOfMapsAddEntriesWherePosesAreEstimated) {
    auto found = kFound;
    found.corrections = 3;
    EXPECT_EQ(contradiction_in(found), "nothing");
    found.revision = 507;
    EXPECT_EQ(contradiction_in(found), "nothing");
    found.revision = 508;
    EXPECT_THAT(contradiction_in(found), HasSubstr("at revision 508; its scans and robots need 504 entries"));
    found.revision = 503;
    EXPECT_THAT(contradiction_in(found), HasSubstr("at revision 503; its scans and robots need 504 entries"));
}

Evidence good_evidence() {
    Evidence evidence;
    evidence.scans_sent = evidence.scans_acknowledged = evidence.scans_in_sessions = 12'000;
    evidence.sessions = evidence.digests_equal = 20;
    return evidence;
}

TEST(Verdict, GoodVerdictListsWhatWasVerified) {
    auto evidence = good_evidence();
    EXPECT_TRUE(verdict_on(evidence).is_good);
    EXPECT_EQ(verdict_on(evidence).sentence, "nothing lost: 12,000 of 12,000 scans acknowledged, 12,000 in the 20 "
                                             "sessions, the digests of all 20 equal that of an undisturbed run");
    evidence.shares_sessions = true;
    EXPECT_TRUE(verdict_on(evidence).is_good);
    EXPECT_THAT(verdict_on(evidence).sentence, HasSubstr("digests cannot be compared"));
    evidence.verify = Verify::kCounts;
    EXPECT_THAT(verdict_on(evidence).sentence, HasSubstr("digests were not compared (--verify counts)"));
    evidence.verify = Verify::kNone;
    EXPECT_THAT(verdict_on(evidence).sentence, HasSubstr("not verified (--verify none)"));
}

TEST(Verdict, AnyContradictionMakesTheVerdictBad) {
    auto evidence = good_evidence();
    evidence.scans_acknowledged = 11'999;
    EXPECT_FALSE(verdict_on(evidence).is_good);
    EXPECT_THAT(verdict_on(evidence).sentence, StartsWith("NOT DONE: 11,999 of 12,000 scans acknowledged"));
    evidence = good_evidence();
    evidence.failures = {"robot r0 gave up"};
    EXPECT_FALSE(verdict_on(evidence).is_good);
    EXPECT_THAT(verdict_on(evidence).sentence, HasSubstr("robot r0 gave up"));
    evidence.contradictions = {"a", "b", "c", "d", "e"};
    EXPECT_FALSE(verdict_on(evidence).is_good);
    EXPECT_THAT(verdict_on(evidence).sentence, HasSubstr("but a; b; c; and 2 more"));
    evidence.scans_lost = 7;
    EXPECT_FALSE(verdict_on(evidence).is_good);
    EXPECT_THAT(verdict_on(evidence).sentence, StartsWith("LOST: 7 acknowledged scans are missing"));
}

} // namespace
} // namespace scanloom::load
