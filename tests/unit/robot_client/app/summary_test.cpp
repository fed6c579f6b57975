#include "robot_client/app/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

const Summary kSummary{"lab",
                       "r1",
                       "carmen:9f3a",
                       "time",
                       {.resumed_after = 10,
                        .last = 30,
                        .acknowledged = 25,
                        .sent = 18,
                        .bytes = 4321,
                        .reconnects = 2,
                        .waiting = 7,
                        .dropped = 1},
                       3,
                       std::nullopt,
                       1500ms,
                       std::nullopt,
                       "",
                       ""};

TEST(SummaryJson, HasScansStoredBeforeAndSentNow) {
    EXPECT_EQ(
        summary_json(kSummary),
        R"({"scans":38,"acknowledged":25,"stored_before":10,"sent":18,"bytes":4321,"seconds":1.500,)"
        R"("skipped_lines":3,"reconnects":2,"waiting":7,"dropped":1,"session":"lab","robot":"r1","source":"carmen:9f3a","order":"time"})");
}

TEST(SummaryJson, RefusedRobotHasReasonAndScanCount) {
    Summary refused = kSummary;
    refused.status = {};
    refused.scan_count = 910;
    refused.localization = "lost";
    refused.remarks = "7 m driven";
    refused.error = "hello.session is \"lab\",\nwhich is full";
    EXPECT_EQ(
        summary_json(refused),
        R"({"scans":910,"acknowledged":0,"stored_before":0,"sent":0,"bytes":0,"seconds":1.500,"skipped_lines":3,)"
        R"("reconnects":0,"waiting":0,"dropped":0,"session":"lab","robot":"r1","source":"carmen:9f3a","order":"time",)"
        R"("localization":"lost","remarks":"7 m driven","error":"hello.session is \"lab\",\nwhich is full"})");
}

TEST(SummaryJson, SaysWhatARecordingLeavesOut) {
    Summary recording = kSummary;
    recording.skipped_lines.reset();
    recording.left_out = LeftOut{{{"\"a\" is unknown", 2}, {"mount unknown", 5}}, 1};
    EXPECT_THAT(summary_json(recording),
                testing::HasSubstr(R"("seconds":1.500,"skipped":{"\"a\" is unknown":2,"mount unknown":5},)"
                                   R"("lost_parts":1,"reconnects":2)"));
    recording.left_out = LeftOut();
    EXPECT_THAT(summary_json(recording), testing::HasSubstr(R"("skipped":{},"lost_parts":0,)"));
}

TEST(SummaryJson, CountsScansWithoutAServer) {
    Summary sensor = kSummary;
    sensor.status = {.waiting = 170};
    sensor.order = {};
    sensor.skipped_lines = std::nullopt;
    EXPECT_EQ(summary_json(sensor),
              R"({"scans":170,"acknowledged":0,"stored_before":0,"sent":0,"bytes":0,"seconds":1.500,"reconnects":0,)"
              R"("waiting":170,"dropped":0,"session":"lab","robot":"r1","source":"carmen:9f3a"})");
}

} // namespace
} // namespace scanloom::robot
