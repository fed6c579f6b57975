#include "lab/recorded_log.hpp"

#include "tests/support/temporary_directory.hpp"
#include "tests/unit/lab/driven_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

TEST(NameOfLog, IsThatOfTheFileWithoutItsEndings) {
    EXPECT_EQ(name_of_log("/a/b.c/intel.clf.bz2"), "intel");
    EXPECT_EQ(name_of_log("fr079.log.gz"), "fr079");
    EXPECT_EQ(name_of_log("plain.clf"), "plain");
    EXPECT_EQ(name_of_log("run.2.clf"), "run_2");
    EXPECT_EQ(name_of_log("my run|(a).clf"), "my_run__a_");
    EXPECT_EQ(name_of_log("first-run"), "first-run");
}

TEST(RecordedLogTest, HasScansWithOdometryAndRelationsOfTheFiles) {
    const auto driven = driven_log();
    const TemporaryDirectory place;
    const auto log_file = place.path() / "room.clf";
    const auto relations_file = place.path() / "room.relations";
    std::ofstream(log_file) << "# a comment\nODOM 0 0 0 0 0 0 1 host 1\n" << carmen_text(driven.log);
    std::ofstream(relations_file) << relations_text(driven.log);
    const auto log = read_recorded_log({log_file.string(), relations_file.string()});
    ASSERT_TRUE(log) << log.error().message;
    EXPECT_EQ(log->name, "room");
    ASSERT_EQ(log->scans.size(), driven.log.scans.size());
    ASSERT_EQ(log->relations.size(), driven.log.relations.size());
    const auto odometry = odometry_of(*log);
    for (std::size_t n = 0; n < log->scans.size(); ++n) {
        EXPECT_FALSE(log->scans[n].scan.pose);
        EXPECT_EQ(odometry[n].stamp, driven.log.scans[n].scan.stamp);
        EXPECT_NEAR(odometry[n].robot.x, driven.log.scans[n].scan.odometry->x, 1e-8);
        EXPECT_NEAR(odometry[n].robot.yaw, driven.log.scans[n].scan.odometry->yaw, 1e-8);
    }
}

TEST(RecordedLogTest, FilesThatCannotBeReadAreErrorsWithTheirNames) {
    const auto driven = driven_log();
    const TemporaryDirectory place;
    const auto log_file = (place.path() / "room.clf").string();
    const auto relations_file = (place.path() / "room.relations").string();
    std::ofstream(log_file) << carmen_text(driven.log);
    std::ofstream(relations_file) << relations_text(driven.log);
    EXPECT_THAT(read_recorded_log({log_file, "/nonexistent/a.relations"}).error().message, HasSubstr("a.relations"));
    EXPECT_THAT(read_recorded_log({"/nonexistent/a.clf", relations_file}).error().message, HasSubstr("a.clf"));
    EXPECT_THAT(read_recorded_log({relations_file, relations_file}).error().message, HasSubstr("room.relations"));
    EXPECT_THAT(read_recorded_log({log_file, log_file}).error().message, HasSubstr("room.clf:1: "));
}

TEST(LogReplayTest, GivesTheScansWithOrWithoutOdometry) {
    const auto driven = driven_log();
    for (const Poses poses : {Poses::kOdometry, Poses::kNone}) {
        LogReplay replay(driven.log, poses);
        EXPECT_EQ(replay.scan_count(), driven.log.scans.size());
        for (const auto& [sensor, scan] : driven.log.scans) {
            const auto observation = replay.next();
            ASSERT_TRUE(observation && *observation);
            EXPECT_EQ((*observation)->sensor, sensor);
            EXPECT_EQ((*observation)->scan.ranges, scan.ranges);
            EXPECT_TRUE(robot::agrees_with((*observation)->scan, poses));
        }
        EXPECT_FALSE(*replay.next());
        EXPECT_FALSE(*replay.next());
    }
}

} // namespace
} // namespace scanloom::lab
