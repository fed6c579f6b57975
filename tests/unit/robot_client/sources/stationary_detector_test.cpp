#include "robot_client/sources/stationary_detector.hpp"

#include "robot_client/lidars/ld06_capture.hpp"
#include "tests/support/angles.hpp"
#include "tests/unit/robot_client/sources/carried_lidar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace scanloom::robot {
namespace {

using Verdict = StationaryDetector::Verdict;

StationaryDetector learnt(const std::vector<Observation>& turns) {
    StationaryDetector detection;
    for (const auto& turn : turns) detection.learn(profile_of(turn.scan, *turn.sensor));
    return detection;
}

double changed(const StationaryDetector& detection, const Observation& turn) {
    return detection.changed_part(profile_of(turn.scan, *turn.sensor)).value_or(-1.0);
}

Verdict judged(const StationaryDetector& detection, const Observation& turn) {
    return detection.judge(profile_of(turn.scan, *turn.sensor));
}

/// Returns the turn as observed from another pose, with the beams at the angles of the same points.
Observation as_from(const Pose2& T_was_is, Observation turn) {
    const BeamAngles angles = angles_of(turn.scan, *turn.sensor);
    ExplicitAngles seen_at;
    for (std::size_t beam = 0; beam < turn.scan.ranges.size(); ++beam) {
        RangeMm& range = turn.scan.ranges[beam];
        const double angle = beam_angle(angles, beam);
        const bool is_hit = range != kInvalidRange && range != kNoReturn;
        const Point2 met = transform(inverse(T_was_is), range * 1e-3 * Point2{std::cos(angle), std::sin(angle)});
        seen_at.push_back(is_hit ? std::atan2(met.y, met.x) : angle - T_was_is.yaw);
        if (is_hit) range = to_range_mm(norm(met));
    }
    turn.scan.angles = std::move(seen_at);
    return turn;
}

std::vector<Pose2> moves_of(double metres) {
    std::vector<Pose2> moves;
    for (int n = 0; n < 8; ++n)
        moves.push_back({metres * std::cos(45 * n * kDegree), metres * std::sin(45 * n * kDegree), 0});
    return moves;
}

TEST(TurnProfile, IsTheMedianReadingPerDirection) {
    Sensor sensor;
    sensor.range_max = 10.0;
    Scan scan;
    scan.angles =
        ExplicitAngles{0.2 * kDegree, 0.4 * kDegree, 0.6 * kDegree, 90.5 * kDegree, -0.5 * kDegree, 361.5 * kDegree};
    scan.ranges = {1000, 5000, 2000, kInvalidRange, 3000, kNoReturn};
    const auto profile = profile_of(scan, sensor);
    EXPECT_DOUBLE_EQ(profile[0], 2.0);
    EXPECT_DOUBLE_EQ(profile[359], 3.0);
    EXPECT_TRUE(std::isnan(profile[90])) << "an invalid reading has no value";
    EXPECT_TRUE(std::isnan(profile[1])) << "a no-return has no value";
    EXPECT_TRUE(std::isnan(profile[180])) << "a direction without a beam has no value";
}

TEST(StationaryDetection, StationarySensorIsStillAtAnyPlace) {
    for (const auto make : {sim::make_room, sim::make_office}) {
        CarriedLidar lidar(make());
        for (int place = 0; place < 20; ++place) {
            const Pose2 here = lidar.any_place();
            StationaryDetector detection;
            for (const auto& turn : lidar.turns_at(here, StationaryDetector::kTurnsMax)) {
                EXPECT_EQ(judged(detection, turn), Verdict::kStill) << detection.turns() << " turns learnt";
                detection.learn(profile_of(turn.scan, *turn.sensor));
            }
            for (const auto& turn : lidar.turns_at(here, 10)) EXPECT_LT(changed(detection, turn), 0.1);
        }
    }
}

TEST(StationaryDetection, DetectsAMovementOfTenCentimetresInARoom) {
    CarriedLidar lidar;
    for (int place = 0; place < 20; ++place) {
        const Pose2 here = lidar.any_place();
        const auto detection = learnt(lidar.turns_at(here, StationaryDetector::kTurnsMax));
        for (const auto& move : moves_of(0.1)) {
            EXPECT_EQ(judged(detection, lidar.turn_at(compose(here, move))), Verdict::kMoved)
                << here.x << " " << here.y << " by " << move.x << " " << move.y;
        }
    }
}

TEST(StationaryDetection, DetectsARotationOfFiveDegrees) {
    for (const auto make : {sim::make_room, sim::make_office, sim::make_hall}) {
        CarriedLidar lidar(make());
        for (int place = 0; place < 20; ++place) {
            const Pose2 here = lidar.any_place();
            const auto detection = learnt(lidar.turns_at(here, StationaryDetector::kTurnsMax));
            for (const double turn : {5.0, -5.0}) {
                EXPECT_GT(changed(detection, lidar.turn_at(compose(here, {0, 0, turn * kDegree}))), 0.35)
                    << here.x << " " << here.y;
            }
        }
    }
}

TEST(StationaryDetection, DetectsASensorThatIsBeingPutDown) {
    CarriedLidar lidar;
    int noticed = 0;
    for (int place = 0; place < 20; ++place) {
        const Pose2 here = lidar.any_place();
        const auto detection = learnt(lidar.turns_at(here, 5));
        for (const auto& move : moves_of(0.06)) {
            noticed += judged(detection, lidar.turn_at(compose(here, move))) == Verdict::kMoved ? 1 : 0;
        }
    }
    EXPECT_GT(noticed, 20 * 8 * 9 / 10);
}

TEST(StationaryDetection, IgnoresPeopleWalkingAround) {
    CarriedLidar lidar;
    for (int place = 0; place < 20; ++place) {
        const Pose2 here = lidar.any_place();
        const auto detection = learnt(lidar.turns_at(here, StationaryDetector::kTurnsMax));
        for (const auto& step : moves_of(0.5)) {
            const Point2 there{here.x + step.x, here.y + step.y};
            lidar.world().walkers = {{.loop = {there, {there.x + 1.0, there.y}}}};
            EXPECT_EQ(judged(detection, lidar.turn_at(here)), Verdict::kStill);
        }
        lidar.world().walkers.clear();
    }
}

TEST(StationaryDetection, IgnoresMissingReadings) {
    CarriedLidar lidar;
    const auto with_gaps = [&](const Pose2& place) {
        Observation turn = lidar.turn_at(place);
        for (auto& range : turn.scan.ranges) {
            if (lidar.random().uniform(0.0, 1.0) < 0.4) range = kInvalidRange;
        }
        return turn;
    };
    std::vector<Observation> turns;
    for (std::size_t n = 0; n < StationaryDetector::kTurnsMax; ++n) turns.push_back(with_gaps(kHere));
    const auto detection = learnt(turns);
    for (int n = 0; n < 10; ++n) {
        EXPECT_EQ(judged(detection, with_gaps(kHere)), Verdict::kStill);
        EXPECT_EQ(judged(detection, with_gaps({-3.5, -2.85, 0.3})), Verdict::kMoved);
    }
}

TEST(StationaryDetection, TooFewReadingsAreUnclear) {
    CarriedLidar lidar;
    const auto part_of_a_turn = [&](std::size_t beams) {
        Observation turn = lidar.turn_at(kHere);
        std::fill(turn.scan.ranges.begin() + static_cast<std::ptrdiff_t>(beams), turn.scan.ranges.end(), kInvalidRange);
        return turn;
    };
    EXPECT_EQ(judged({}, part_of_a_turn(30)), Verdict::kUnclear);
    EXPECT_EQ(judged({}, part_of_a_turn(40)), Verdict::kStill);
    const auto detection = learnt(lidar.turns_at(kHere, StationaryDetector::kTurnsMax));
    EXPECT_EQ(judged(detection, part_of_a_turn(0)), Verdict::kUnclear);
    EXPECT_EQ(judged(detection, part_of_a_turn(60)), Verdict::kUnclear);
    EXPECT_EQ(judged(detection, part_of_a_turn(80)), Verdict::kStill);
}

/// Checks the numbers in stillness.hpp with a real recording.
TEST(StationaryDetection, RealRecordingHasMarginOnBothSides) {
    const std::filesystem::path path = SCANLOOM_SOURCE_DIR "/../shared/data/ld06/capture.bin";
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << path;
    auto capture = Ld06Capture::open(path, {}, Pose2{}).value();
    std::vector<Observation> turns;
    for (auto next = capture.next(); next && *next; next = capture.next()) turns.push_back(**next);
    for (std::size_t first = 0; first + StationaryDetector::kTurnsMax < turns.size(); first += 70) {
        const auto begin = turns.begin() + static_cast<std::ptrdiff_t>(first);
        const auto detection = learnt({begin, begin + StationaryDetector::kTurnsMax});
        for (std::size_t n = 0; n < turns.size(); ++n) {
            EXPECT_LE(changed(detection, turns[n]), 0.03);
            const bool is_part = turns[n].scan.ranges.size() < 440;
            if (is_part || n % 20 != 0) continue;
            for (const auto& move : moves_of(0.1)) EXPECT_GE(changed(detection, as_from(move, turns[n])), 0.36);
            for (const double turn : {5.0, -5.0}) {
                EXPECT_GE(changed(detection, as_from({0.0, 0.0, turn * kDegree}, turns[n])), 0.5);
            }
        }
    }
}

} // namespace
} // namespace scanloom::robot
