#include "server/sessions/log_reconstruction.hpp"

#include "common/wire/log_codec.hpp"
#include "core/mapping/projection.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace scanloom::sessions {
namespace {

using testing_support::random_scan;
using testing_support::small_laser;

std::vector<LogEntry> log_of_three_robots() {
    std::vector<LogEntry> log;
    for (RobotIndex robot = 0; robot < 3; ++robot) {
        log.push_back(RobotJoined{robot, std::string(1, static_cast<char>('a' + robot))});
        log.push_back(SensorDescribed{robot, small_laser()});
    }
    for (std::uint64_t seq = 1; seq <= 30; ++seq) {
        for (RobotIndex robot = 0; robot < 3; ++robot) log.push_back(ScanTaken{robot, random_scan(robot, seq)});
    }
    return log;
}

/// Computes the expected result by the definition: all remaining scans of known robots and sensors.
struct ExpectedLog {
    explicit ExpectedLog(const std::vector<LogEntry>& log, const std::set<std::size_t>& lost) {
        std::map<RobotIndex, RobotIndex> robots;
        std::set<RobotIndex> described;
        std::map<RobotIndex, std::uint64_t> seqs;
        mapping::Projection projection{mapping::MapConfig{}};
        for (std::size_t n = 0; n < log.size(); ++n) {
            if (lost.contains(n)) continue;
            if (const auto* joined = std::get_if<RobotJoined>(&log[n])) {
                robots.emplace(joined->robot, robots.size());
                static_cast<void>(projection.apply(RobotJoined{robots[joined->robot], joined->name}));
            } else if (const auto* sensor = std::get_if<SensorDescribed>(&log[n])) {
                if (!robots.contains(sensor->robot)) continue;
                described.insert(sensor->robot);
                static_cast<void>(projection.apply(SensorDescribed{robots[sensor->robot], sensor->sensor}));
            } else {
                auto taken = std::get<ScanTaken>(log[n]);
                if (!described.contains(taken.robot)) continue;
                taken.scan.seq = ++seqs[taken.robot];
                taken.robot = robots[taken.robot];
                static_cast<void>(projection.apply(taken));
                ++scans;
            }
        }
        digests = testing_support::digests_of(projection.snapshot());
    }

    std::size_t scans = 0;
    std::string digests;
};

TEST(LogReconstruction, KeepsEveryUsableScanAndItsSequenceNumber) {
    const auto log = log_of_three_robots();
    std::mt19937 random(1);
    std::uint64_t empty_scans = 0;
    for (int round = 0; round < 60; ++round) {
        std::set<std::size_t> lost;
        for (std::size_t n = random() % 12; n > 0; --n) lost.insert(random() % log.size());
        if (round % 3 == 0) lost.insert(random() % 6); // a robot or a sensor
        LogReconstruction reconstruction;
        mapping::Projection projection{mapping::MapConfig{}};
        std::size_t scans = 0;
        for (std::size_t n = 0; n < log.size(); ++n) {
            if (lost.contains(n)) continue;
            const auto entries = reconstruction.add(n + 1, log[n]);
            for (const auto& entry : entries) {
                ASSERT_EQ(wire::decode_entry(wire::encode_entry(entry)).value(), entry)
                    << "the entry must survive encoding";
                const auto applied = projection.apply(entry);
                ASSERT_TRUE(applied) << applied.error().message;
            }
            const auto* taken = std::get_if<ScanTaken>(&log[n]);
            if (taken == nullptr || entries.empty()) continue;
            ++scans;
            const auto& kept = std::get<ScanTaken>(entries.back()).scan;
            ASSERT_EQ(kept, taken->scan);
        }
        const ExpectedLog expected(log, lost);
        EXPECT_EQ(scans, expected.scans);
        EXPECT_EQ(testing_support::digests_of(projection.snapshot()), expected.digests);
        EXPECT_LE(reconstruction.empty_scans(), lost.size());
        empty_scans += reconstruction.empty_scans();
    }
    EXPECT_GT(empty_scans, 100U);
}

TEST(LogReconstruction, UndamagedLogIsUnchanged) {
    LogReconstruction reconstruction;
    Revision revision = 0;
    for (const auto& entry : log_of_three_robots()) {
        ASSERT_EQ(reconstruction.add(++revision, entry), std::vector<LogEntry>{entry});
    }
    EXPECT_EQ(reconstruction.missing(), 0U);
    EXPECT_EQ(reconstruction.empty_scans(), 0U);
}

TEST(LogReconstruction, AddsALostChangeOfTheMode) {
    const auto scan = [](std::uint64_t seq, bool is_localize_only) {
        return ScanTaken{0, random_scan(0, seq), is_localize_only};
    };
    const std::vector<LogEntry> log{RobotJoined{0, "a"}, SensorDescribed{0, small_laser()},
                                    scan(1, false),      ModeChanged{true},
                                    scan(2, true),       scan(3, true)};
    LogReconstruction reconstruction;
    std::vector<LogEntry> kept;
    for (const std::size_t n : {0U, 1U, 2U, 5U}) {
        for (auto& entry : reconstruction.add(n + 1, log[n])) kept.push_back(std::move(entry));
    }
    ASSERT_EQ(kept.size(), log.size());
    EXPECT_EQ(kept[3], log[3]);
    EXPECT_TRUE(std::get<ScanTaken>(kept[4]).is_localize_only) << "the empty scan";
    EXPECT_EQ(kept[5], log[5]);
    EXPECT_EQ(reconstruction.empty_scans(), 1U);
}

TEST(LogReconstruction, RelocalizedRobotsHaveTheirNewNumbers) {
    LogReconstruction reconstruction;
    ASSERT_EQ(reconstruction.add(2, RobotJoined{1, "b", "", std::nullopt, Poses::kOdometry}).size(), 1U);
    const auto kept = reconstruction.add(3, RobotRelocalized{1, {2.0, 3.0}, 1.0});
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_EQ(kept[0], LogEntry(RobotRelocalized{0, {2.0, 3.0}, 1.0}));
}

TEST(LogReconstruction, DropsScansAcrossAnImpossibleGap) {
    LogReconstruction reconstruction;
    static_cast<void>(reconstruction.add(1, RobotJoined{0, "a"}));
    static_cast<void>(reconstruction.add(2, SensorDescribed{0, small_laser()}));
    EXPECT_TRUE(reconstruction.add(5, ScanTaken{0, random_scan(1, 4)}).empty()) << "2 entries are missing, but 3 scans";
    EXPECT_EQ(reconstruction.add(6, ScanTaken{0, random_scan(1, 3)}).size(), 3U);
    EXPECT_EQ(reconstruction.missing(), 2U);
}

TEST(LogReconstruction, DropsScanThatDoesNotMatchItsSensor) {
    Sensor other = small_laser();
    other.angles = ExplicitAngles{0.0, 0.1};
    LogReconstruction reconstruction;
    static_cast<void>(reconstruction.add(1, RobotJoined{0, "a"}));
    static_cast<void>(reconstruction.add(2, SensorDescribed{0, other}));
    EXPECT_TRUE(reconstruction.add(4, ScanTaken{0, random_scan(1, 1)}).empty()) << "the sensor's description is lost";
}

} // namespace
} // namespace scanloom::sessions
