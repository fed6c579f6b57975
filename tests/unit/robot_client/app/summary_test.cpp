#include "robot_client/app/summary.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

const Summary kSummary{
    "lab", "r1",   {.resumed_after = 10, .last = 30, .acknowledged = 25, .bytes = 4321, .reconnects = 2},
    3,     1500ms, true};

TEST(SummaryJson, ARecordingCountsFromItsBeginning) {
    EXPECT_EQ(summary_json(kSummary),
              R"({"scans":30,"acknowledged":25,"bytes":4321,"seconds":1.500,"resumed_after":10,"skipped_lines":3,)"
              R"("reconnects":2,"session":"lab","robot":"r1"})");
}

TEST(SummaryJson, ASimulationCountsThisRunOnly) {
    Summary summary = kSummary;
    summary.is_recording = false;
    EXPECT_TRUE(summary_json(summary).starts_with(R"({"scans":20,"acknowledged":15,)"));
}

} // namespace
} // namespace scanloom::robot
