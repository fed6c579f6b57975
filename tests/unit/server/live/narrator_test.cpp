#include "server/live/core/narrator.hpp"

#include "server/live/core/scan_points.hpp"
#include "server/mapping/projection.hpp"
#include "tests/support/live_replay.hpp"
#include "tests/support/random_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace scanloom::live {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::LiveReplay;

/// A session's maps while robots stream, one entry at a time.
class Growing {
public:
    explicit Growing(std::uint32_t robots) {
        Sensor sonar{.id = 9, .kind = SensorKind::kSonar, .angles = UniformAngles{0.0, 1.0, 6}, .range_max = 4.0};
        for (std::uint32_t robot = 0; robot < robots; ++robot) {
            fold(RobotJoined{robot, "r" + std::to_string(robot)});
            fold(SensorDescribed{robot, testing_support::small_laser()});
            fold(SensorDescribed{robot, sonar});
        }
        newest_.resize(robots);
        connected.resize(robots, true);
    }

    void scan(RobotIndex robot) {
        const std::uint64_t seq = maps().robots[robot].last_seq + 1;
        Scan scan = testing_support::random_scan(robot + 1, seq);
        if (seq % 3 == 0) {
            scan.sensor = 9;
            scan.ranges.resize(6);
        }
        take(robot, std::move(scan));
    }

    void take(RobotIndex robot, Scan scan) {
        fold(ScanTaken{robot, scan});
        newest_[robot] = std::make_shared<const mapping::FoldedScan>(
            mapping::FoldedScan{projection_.revision(), projection_.sensor_of(robot, scan.sensor), std::move(scan)});
    }

    void fold(const LogEntry& entry) { projection_.fold(entry).value(); }

    [[nodiscard]] mapping::Snapshot maps() {
        auto maps = projection_.snapshot();
        for (std::size_t n = 0; n < newest_.size(); ++n) maps.robots[n].newest_scan = newest_[n];
        return maps;
    }

    [[nodiscard]] Moment moment() {
        return {std::make_shared<const mapping::Snapshot>(maps()), connected, wire::LiveState::kOk, {}};
    }

    std::vector<bool> connected;

private:
    mapping::Projection projection_{mapping::resolve({.cell_size = 0.05}).value()};
    std::vector<std::shared_ptr<const mapping::FoldedScan>> newest_;
};

TEST(Narrator, WhoeverReadsEveryEventKnowsTheNewestSnapshotWhateverWasSkipped) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        std::mt19937 random(seed);
        Growing session(3);
        Narrator narrator("tag");
        LiveReplay viewer;
        for (int step = 0; step < 120; ++step) {
            if (random() % 8 == 0) {
                session.connected[random() % 3] = random() % 2 == 0;
            } else {
                session.scan(static_cast<RobotIndex>(random() % 3));
            }
            if (random() % 4 != 0) continue; // the viewer is busy
            const Moment moment = session.moment();
            if (const auto event = narrator.next(moment)) viewer.take(wire::encode(*event));
            ASSERT_NO_FATAL_FAILURE(viewer.expect_equal_to(*moment.maps, moment.connected)) << "seed " << seed;
            EXPECT_EQ(narrator.next(moment), std::nullopt) << "nothing is said twice";
        }
        EXPECT_THAT(viewer.everything, IsEmpty());
    }
}

TEST(Narrator, ATrailWithoutGapsIsToldPointByPoint) {
    Growing session(1);
    Narrator narrator("tag");
    LiveReplay viewer;
    for (int n = 0; n < 600; ++n) {
        session.scan(0);
        if (n % 200 == 199) viewer.take(wire::encode(*narrator.next(session.moment())));
    }
    EXPECT_EQ(viewer.robots.at(0).trail.size(), 600U);
}

TEST(Narrator, OfALongTrailTheNewestPointsAreToldAndHowManyThereAreBefore) {
    Growing session(1);
    for (int n = 0; n < 300; ++n) session.scan(0);
    Narrator narrator("tag");
    const auto event = narrator.next(session.moment());
    EXPECT_EQ(event->robots.at(0).trail.size(), kTrailMax);
    EXPECT_EQ(event->robots.at(0).trail_from, 300 - kTrailMax);
}

TEST(Narrator, TooManyTilesAreEverything) {
    mapping::LaserLayers layers{mapping::MapConfig{}};
    const auto maps_with_rows = [&](std::int32_t rows, Revision revision) {
        for (std::int32_t cj = 0; cj < 4 * rows; cj += 4) {
            for (std::int32_t ci = 0; ci < 4 * 64; ci += 4) layers.restore({cj, ci}, revision).occupancy.fill(0);
        }
        return std::make_shared<const mapping::Snapshot>(
            mapping::Snapshot{.revision = revision, .laser = layers.snapshot()});
    };
    Narrator narrator("tag");
    const auto most = narrator.next({maps_with_rows(32, 1), {}, wire::LiveState::kOk, {}});
    ASSERT_EQ(most->tiles.size(), 2U); // occupancy and himm share their chunks
    EXPECT_FALSE(most->tiles[0].everything);
    EXPECT_EQ(most->tiles[0].tiles.size(), kTilesMax);
    const auto more = narrator.next({maps_with_rows(33, 2), {}, wire::LiveState::kOk, {}});
    ASSERT_EQ(more->tiles.size(), 2U);
    EXPECT_TRUE(more->tiles[0].everything);
    EXPECT_THAT(more->tiles[0].tiles, IsEmpty());
}

TEST(Narrator, LayersAreToldOnlyWhereTheyAreWishedForAndGoOnFromWhereTheyWere) {
    Growing session(1);
    session.scan(0);
    Narrator narrator("tag");
    narrator.set_wishes(wishes_of({{wire::LiveLayer::kHimm}, false}));
    LiveReplay viewer;
    viewer.take(wire::encode(*narrator.next(session.moment())));
    EXPECT_THAT(viewer.tiles, ElementsAre(testing::Key(v1::LAYER_HIMM)));
    EXPECT_FALSE(viewer.robots.at(0).scan.has_origin());

    session.scan(0);
    narrator.set_wishes(Wishes{});
    const Moment moment = session.moment();
    viewer.take(wire::encode(*narrator.next(moment)));
    viewer.expect_equal_to(*moment.maps, moment.connected);
    EXPECT_TRUE(viewer.robots.at(0).scan.has_origin());
}

TEST(Narrator, AScanIsToldAnewWhenPointsAreWishedForLater) {
    Growing session(1);
    session.scan(0);
    Narrator narrator("tag");
    narrator.set_wishes({{}, false});
    EXPECT_FALSE(narrator.next(session.moment())->robots.at(0).scan);
    for (int n = 0; n < 2; ++n) {
        narrator.set_wishes({{}, false});
        EXPECT_FALSE(narrator.next(session.moment()));
        narrator.set_wishes({{}, true});
        const auto event = narrator.next(session.moment());
        ASSERT_TRUE(event);
        EXPECT_TRUE(event->robots.at(0).scan);
    }
}

TEST(Narrator, AnotherStateIsNewsWithItsReason) {
    Growing session(1);
    Narrator narrator("tag");
    Moment moment = session.moment();
    EXPECT_EQ(narrator.next(moment)->state, wire::LiveState::kOk);
    moment.state = wire::LiveState::kDraining;
    moment.reason = "the server is shutting down";
    const auto event = narrator.next(moment);
    EXPECT_EQ(event->state, wire::LiveState::kDraining);
    EXPECT_EQ(event->reason, moment.reason);
    EXPECT_EQ(narrator.next(moment), std::nullopt);
}

TEST(Narrator, AnotherBodyIsNews) {
    Growing session(2);
    Narrator narrator("tag");
    const auto told = [&] {
        v1::LiveEvent event;
        EXPECT_TRUE(event.ParseFromString(wire::encode(narrator.next(session.moment()).value())));
        return event;
    };
    EXPECT_EQ(told().robots(0).body_radius(), 0.0) << "not stated";
    for (const double radius : {0.25, 0.5}) {
        session.fold(RobotJoined{1, "r1", "", radius});
        const auto event = told();
        ASSERT_EQ(event.robots_size(), 1);
        EXPECT_EQ(event.robots(0).robot(), 1U);
        EXPECT_EQ(event.robots(0).body_radius(), radius);
    }
    EXPECT_EQ(narrator.next(session.moment()), std::nullopt);
}

TEST(Narrator, GoalsAloneAreNews) {
    Growing session(1);
    session.scan(0);
    Narrator narrator("tag");
    Moment moment = session.moment();
    EXPECT_EQ(narrator.next(moment)->goals_revision, 0U);
    moment.goals_revision = 3;
    EXPECT_EQ(narrator.next(moment)->goals_revision, 3U);
    EXPECT_EQ(narrator.next(moment), std::nullopt);
    session.scan(0);
    Moment later = session.moment();
    later.goals_revision = 3;
    v1::LiveEvent event;
    ASSERT_TRUE(event.ParseFromString(wire::encode(*narrator.next(later))));
    EXPECT_EQ(event.goals_revision(), 3U) << "in every event";
}

TEST(Narrator, AnEventIsBoundedHoweverManyRobotsThereAre) {
    constexpr std::uint32_t kRobots = 1024;
    mapping::Snapshot maps{.revision = 9};
    const auto sensor =
        std::make_shared<const Sensor>(Sensor{.angles = UniformAngles{0.0, 0.001, 4096}, .range_max = 1000.0});
    Scan scan;
    scan.ranges.assign(4096, 999'999);
    const auto newest = std::make_shared<const mapping::FoldedScan>(mapping::FoldedScan{9, sensor, scan});
    mapping::Trajectory trail;
    for (int n = 0; n < 1000; ++n) trail.append({1, 0.0, {n % 2 == 0 ? 1e6 : -1e6, n % 2 == 0 ? -1e6 : 1e6, 0.0}});
    for (std::uint32_t n = 0; n < kRobots; ++n) {
        maps.robots.push_back({.name = std::string(64, 'r'),
                               .scan_count = 1000,
                               .pose = Pose2{},
                               .trajectory = trail.snapshot(),
                               .newest_scan = newest});
    }
    Narrator narrator("tag");
    const auto event = narrator.next({std::make_shared<const mapping::Snapshot>(maps), {}, wire::LiveState::kOk, {}});
    std::size_t points = 0;
    std::size_t trails = 0;
    for (const auto& robot : event->robots) {
        points += robot.scan->points.size();
        trails += robot.trail.size();
    }
    EXPECT_EQ(event->robots.size(), kRobots);
    EXPECT_LE(points, kScanPointsMax + kRobots);
    EXPECT_GE(points, kScanPointsMax / 2);
    EXPECT_LE(trails, kTrailsMax);
    const auto bytes = wire::encode(*event);
    EXPECT_LE(bytes.size(), 512U * 1024U);
    LiveReplay viewer;
    viewer.take(bytes);
    viewer.expect_equal_to(maps, {}); // even the longest leaps of a trail
}

TEST(ScanPoints, AreWhereTheBeamsEndedAtSomething) {
    Sensor sensor{.id = 3,
                  .mount = {1.0, 0.0, 0.0},
                  .angles = UniformAngles{0.0, std::numbers::pi / 2, 4},
                  .range_min = 0.5,
                  .range_max = 10.0};
    Scan scan;
    scan.stamp = 7.5;
    scan.pose = {5.0, 5.0, std::numbers::pi / 2};
    scan.ranges = {2'000, 3'000, kNoReturn, kInvalidRange};
    const mapping::FoldedScan folded{1, std::make_shared<const Sensor>(sensor), scan};
    const auto points = points_of(folded, 1);
    EXPECT_NEAR(points.origin.x, 5.0, 1e-9);
    EXPECT_NEAR(points.origin.y, 6.0, 1e-9);
    EXPECT_THAT(points.points, ElementsAre(PointMm{0, 2'000}, PointMm{-3'000, 0}));
    EXPECT_EQ(points.stamp, 7.5);

    scan.ranges = {400, 10'000, 1'000, 9'999}; // nearer than range_min, farther than range_max
    const mapping::FoldedScan bounds{1, std::make_shared<const Sensor>(sensor), scan};
    EXPECT_THAT(points_of(bounds, 1).points, ElementsAre(PointMm{0, -1'000}, PointMm{9'999, 0}));
    EXPECT_THAT(points_of(bounds, 2).points, ElementsAre(PointMm{0, -1'000}));
}

} // namespace
} // namespace scanloom::live
