#include "load/app/options.hpp"

#include "load/app/record_workload.hpp"
#include "load/net/fleet.hpp"

#include "scanloom/v1/frame.pb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace scanloom::load {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::variant<LoadOptions, Leave> parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"scanloom-load"};
    argv.insert(argv.end(), words.begin(), words.end());
    return parse_options(static_cast<int>(argv.size()), argv.data());
}

TEST(LoadOptions, EveryRobotHasItsOwnSessionByDefault) {
    EXPECT_EQ(std::get<LoadOptions>(parse({})).sessions, 100U);
    EXPECT_EQ(std::get<LoadOptions>(parse({"--robots", "7"})).sessions, 7U);
    EXPECT_EQ(std::get<LoadOptions>(parse({"--robots", "7", "--sessions", "2"})).sessions, 2U);
}

TEST(LoadOptions, ParsesAllOptions) {
    const auto options = std::get<LoadOptions>(
        parse({"--server", "a:1", "--http", "b:2", "--rate", "0", "--batch", "5", "--faults", "cut=3,stall=4",
               "--verify", "counts", "--viewers", "2", "--tls-ca", "/dev/null", "--keep"}));
    EXPECT_EQ(options.servers.at(0).text(), "a:1");
    EXPECT_EQ(options.http.port, "2");
    EXPECT_EQ(options.rate, 0.0);
    EXPECT_EQ(options.batch, 5U);
    EXPECT_EQ(options.faults, (FaultMeans{3.0, 0.0, 4.0}));
    EXPECT_EQ(options.verify, Verify::kCounts);
    EXPECT_TRUE(options.tls && options.keep && !options.replace);
}

TEST(LoadOptions, InvalidOptionIsAOneLineUsageError) {
    const std::vector<std::pair<std::vector<const char*>, const char*>> mistakes{
        {{"--robots", "0"}, "--robots"},
        {{"--robots", "1.5"}, "--robots"},
        {{"--robots", "3", "--sessions", "4"},
         "--sessions: 4 sessions need at least as many robots, but --robots is 3"},
        {{"--rate", "-1"}, "--rate"},
        {{"--duration", "0"}, "--duration"},
        {{"--batch", "1025"}, "--batch"},
        {{"--faults", "fire=3"}, "--faults: 'fire=3' is not a fault"},
        {{"--http", "https://here"}, "--http: 'https://here' is not HOST:PORT, nor https://HOST:PORT"},
        {{"--server", "here"}, "--server: 'here' is not HOST:PORT"},
        {{"--http", "here:0"}, "--http: 'here:0' is not HOST:PORT, nor https://HOST:PORT"},
        {{"--world", "mars"}, "--world"},
        {{"--verify", "all"}, "--verify"},
        {{"--poses", "true"}, "--poses: 'true' is not map, odometry or none"},
        {{"surplus"}, "surplus"},
    };
    for (const auto& [words, hint] : mistakes) {
        const auto outcome = parse(words);
        ASSERT_TRUE(std::holds_alternative<Leave>(outcome)) << hint;
        const auto& leave = std::get<Leave>(outcome);
        EXPECT_EQ(leave.code, kExitUsage);
        EXPECT_THAT(leave.text, HasSubstr(hint));
        EXPECT_EQ(std::count(leave.text.begin(), leave.text.end(), '\n'), 1) << leave.text;
    }
}

TEST(LoadOptions, HelpNamesEveryOption) {
    const auto help = std::get<Leave>(parse({"--help"}));
    EXPECT_EQ(help.code, kExitDone);
    for (const auto* name : {"--robots", "--sessions", "--rate", "--faults", "--verify", "--json", "--replace"}) {
        EXPECT_THAT(help.text, HasSubstr(name));
    }
}

TEST(DriveCourse, EqualSeedsGiveEqualScansAndOthersDiffer) {
    auto options = std::get<LoadOptions>(parse({"--duration", "2", "--world", "room"}));
    const auto workload = record_workload(options);
    ASSERT_TRUE(workload);
    EXPECT_EQ(workload->scans.size(), 20U); // not more scans than are sent
    EXPECT_EQ(workload->beams, 684U);
    EXPECT_EQ(record_workload(options)->scans.back().bytes(), workload->scans.back().bytes());
    options.seed = 2;
    EXPECT_NE(record_workload(options)->scans.back().bytes(), workload->scans.back().bytes());
}

TEST(DriveCourse, ScansHaveThePosesThatRobotsKnow) {
    const auto last_scan_of = [](const char* poses) {
        const auto workload =
            record_workload(std::get<LoadOptions>(parse({"--duration", "10", "--world", "room", "--poses", poses})));
        v1::Scan scan;
        EXPECT_TRUE(scan.ParseFromString(workload.value().scans.back().bytes()));
        return scan;
    };
    const v1::Scan given = last_scan_of("map");
    EXPECT_TRUE(given.has_pose());
    const v1::Scan drifting = last_scan_of("odometry");
    EXPECT_FALSE(drifting.has_pose());
    ASSERT_TRUE(drifting.has_odometry());
    const double drift =
        std::hypot(drifting.odometry().x() - given.pose().x(), drifting.odometry().y() - given.pose().y());
    EXPECT_GT(drift, 0.001) << "metres";
    EXPECT_LT(drift, 1.0) << "metres";
    const v1::Scan bare = last_scan_of("none");
    EXPECT_FALSE(bare.has_pose() || bare.has_odometry());
    EXPECT_EQ(bare.ranges_size(), given.ranges_size());
}

TEST(DriveCourse, RefusesABatchThatExceedsAFrame) {
    const auto options = std::get<LoadOptions>(parse({"--batch", "1024", "--laser", "wide", "--world", "room"}));
    const auto workload = record_workload(options);
    ASSERT_FALSE(workload);
    EXPECT_EQ(workload.error().code, Errc::kTooLarge);
    EXPECT_THAT(workload.error().message, HasSubstr("--batch 1024"));
}

TEST(SpreadOver, EverySessionGetsEqualStartPositions) {
    const auto plans = spread_over({"a", "b"}, 6, 600);
    std::vector<std::size_t> of_a;
    std::vector<std::size_t> of_b;
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < plans.size(); ++i) {
        EXPECT_EQ(plans[i].index, i);
        (plans[i].session == "a" ? of_a : of_b).push_back(plans[i].first_scan);
        names.insert(plans[i].session + plans[i].name);
    }
    EXPECT_THAT(of_a, ElementsAre(0, 200, 400));
    EXPECT_EQ(of_a, of_b);
    EXPECT_EQ(names.size(), 6U);
}

} // namespace
} // namespace scanloom::load
