#include "sim/robot/simulated_source.hpp"

#include "common/wire/messages.hpp"
#include "sim/drive/wall_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace scanloom::sim {
namespace {

SimulatedSource make(SimulationLimits limits, robot::NoReturn no_return = robot::NoReturn::kFree) {
    return {Simulator({make_office(), *find_laser("reference"), std::nullopt, 3}, std::make_unique<WallFollower>()),
            limits, no_return};
}

std::size_t count(SimulatedSource& source) {
    std::size_t scans = 0;
    while (*source.next()) ++scans;
    return scans;
}

TEST(SimulatedSource, EndsAtItsFirstLimit) {
    for (const auto& [duration, scans, expected] :
         {std::tuple{3.0, 1000U, 30U}, {0.3, 1000U, 3U}, {100.0, 7U, 7U}, {0.31, 99U, 4U}}) {
        auto source = make({duration, scans});
        EXPECT_EQ(source.scan_count(), expected);
        EXPECT_EQ(count(source), expected);
    }
}

/// Returns a source with a laser and sonars.
SimulatedSource make_with_sonar(SimulationLimits limits, std::uint64_t seed, const char* world = "room_walker") {
    SimulatorOptions options{*find_world(world), *find_laser("lidar360"), Noise{.range_uniform = 0.05}, seed};
    options.sonar = *find_sonar("ring16");
    options.pose = PoseSent::kOdometry;
    return {Simulator(std::move(options), std::make_unique<WallFollower>()), limits, robot::NoReturn::kFree};
}

TEST(SimulatedSource, EachSensorScansWithinTheDuration) {
    auto source = make_with_sonar({.duration = 0.31}, 1);
    EXPECT_EQ(source.scan_count(), 8U);
    std::size_t of_sonars = 0;
    while (const auto observation = *source.next()) {
        EXPECT_EQ(observation->sensor->id, observation->scan.sensor);
        EXPECT_EQ(observation->scan.ranges.size(), beam_count(observation->sensor->angles));
        of_sonars += observation->sensor->kind == SensorKind::kSonar;
    }
    EXPECT_EQ(of_sonars, 4U);
}

/// Returns the frames that an uplink would send.
std::vector<std::string> frames_of(SimulatedSource source) {
    std::vector<std::string> frames;
    std::uint64_t seq = 0;
    while (auto observation = *source.next()) {
        observation->scan.seq = ++seq;
        wire::encode(wire::ScanBatch{{observation->scan}}, frames.emplace_back());
    }
    return frames;
}

TEST(SimulatedSource, EqualSeedsGiveEqualBytes) {
    const auto frames = frames_of(make_with_sonar({.scans = 400}, 5));
    EXPECT_EQ(frames.size(), 400U);
    EXPECT_EQ(frames_of(make_with_sonar({.scans = 400}, 5)), frames);
    EXPECT_NE(frames_of(make_with_sonar({.scans = 400}, 6)), frames);
}

TEST(SimulatedSource, ScanCountIsUnknownWithoutLimits) { EXPECT_EQ(make({}).scan_count(), std::nullopt); }

TEST(SimulatedSource, EqualSourcesGiveEqualScans) {
    auto first = make({.scans = 20});
    auto second = make({});
    for (int i = 0; i < 20; ++i) EXPECT_EQ((*second.next())->scan, (*first.next())->scan);
}

TEST(SimulatedSource, NoReturnsAreFreeOrDropped) {
    const auto has = [](const Scan& scan, RangeMm mark) {
        return std::count(scan.ranges.begin(), scan.ranges.end(), mark) > 0;
    };
    auto free = make({.scans = 1});
    auto drop = make({.scans = 1}, robot::NoReturn::kDrop);
    const Scan freed = (*free.next())->scan;
    const Scan dropped = (*drop.next())->scan;
    EXPECT_TRUE(has(freed, kNoReturn) && !has(freed, kInvalidRange));
    EXPECT_TRUE(has(dropped, kInvalidRange) && !has(dropped, kNoReturn));
}

} // namespace
} // namespace scanloom::sim
