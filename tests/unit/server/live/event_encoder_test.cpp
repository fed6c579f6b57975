#include "server/live/core/event_encoder.hpp"

#include "core/mapping/projection.hpp"
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
            apply(RobotJoined{robot, "r" + std::to_string(robot)});
            apply(SensorDescribed{robot, testing_support::small_laser()});
            apply(SensorDescribed{robot, sonar});
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
        apply(ScanTaken{robot, scan});
        newest_[robot] = std::make_shared<const mapping::IntegratedScan>(mapping::IntegratedScan{
            projection_.revision(), projection_.sensor_of(robot, scan.sensor), std::move(scan)});
    }

    void apply(const LogEntry& entry) { projection_.apply(entry).value(); }

    [[nodiscard]] mapping::Snapshot maps() {
        auto maps = projection_.snapshot();
        for (std::size_t n = 0; n < newest_.size(); ++n) maps.robots[n].newest_scan = newest_[n];
        return maps;
    }

    [[nodiscard]] SessionSnapshot snapshot() {
        return {std::make_shared<const mapping::Snapshot>(maps()), connected, wire::LiveState::kOk, {}};
    }

    std::vector<bool> connected;

private:
    mapping::Projection projection_{mapping::resolve({.cell_size = 0.05}).value()};
    std::vector<std::shared_ptr<const mapping::IntegratedScan>> newest_;
};

TEST(EventEncoder, GivesNewestSnapshotToClientThatReadsEveryEvent) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        std::mt19937 random(seed);
        Growing session(3);
        EventEncoder encoder("tag");
        LiveReplay viewer;
        for (int step = 0; step < 120; ++step) {
            if (random() % 8 == 0) {
                session.connected[random() % 3] = random() % 2 == 0;
            } else {
                session.scan(static_cast<RobotIndex>(random() % 3));
            }
            if (random() % 4 != 0) continue; // the viewer is busy
            const SessionSnapshot snapshot = session.snapshot();
            if (const auto event = encoder.next(snapshot)) viewer.take(wire::encode(*event));
            ASSERT_NO_FATAL_FAILURE(viewer.expect_equal_to(*snapshot.maps, snapshot.connected)) << "seed " << seed;
            EXPECT_EQ(encoder.next(snapshot), std::nullopt) << "nothing is sent twice";
        }
        EXPECT_THAT(viewer.everything, IsEmpty());
    }
}

TEST(EventEncoder, SendsEveryTrailPoint) {
    Growing session(1);
    EventEncoder encoder("tag");
    LiveReplay viewer;
    for (int n = 0; n < 600; ++n) {
        session.scan(0);
        if (n % 200 == 199) viewer.take(wire::encode(*encoder.next(session.snapshot())));
    }
    EXPECT_EQ(viewer.robots.at(0).trail.size(), 600U);
}

TEST(EventEncoder, SendsNewestPointsOfLongTrailWithOffset) {
    Growing session(1);
    for (int n = 0; n < 300; ++n) session.scan(0);
    EventEncoder encoder("tag");
    const auto event = encoder.next(session.snapshot());
    EXPECT_EQ(event->robots.at(0).trail.size(), kTrailMax);
    EXPECT_EQ(event->robots.at(0).trail_from, 300 - kTrailMax);
}

TEST(EventEncoder, ReportsEverythingIfTooManyTilesChanged) {
    mapping::LaserLayers layers{mapping::MapConfig{}};
    const auto maps_with_rows = [&](std::int32_t rows, Revision revision) {
        for (std::int32_t cj = 0; cj < 4 * rows; cj += 4) {
            for (std::int32_t ci = 0; ci < 4 * 64; ci += 4) layers.restore({cj, ci}, revision).occupancy.fill(0);
        }
        return std::make_shared<const mapping::Snapshot>(
            mapping::Snapshot{.revision = revision, .laser = layers.snapshot()});
    };
    EventEncoder encoder("tag");
    const auto most = encoder.next({maps_with_rows(32, 1), {}, wire::LiveState::kOk, {}});
    ASSERT_EQ(most->tiles.size(), 2U); // occupancy and himm share their chunks
    EXPECT_FALSE(most->tiles[0].everything);
    EXPECT_EQ(most->tiles[0].tiles.size(), kTilesMax);
    const auto more = encoder.next({maps_with_rows(33, 2), {}, wire::LiveState::kOk, {}});
    ASSERT_EQ(more->tiles.size(), 2U);
    EXPECT_TRUE(more->tiles[0].everything);
    EXPECT_THAT(more->tiles[0].tiles, IsEmpty());
}

TEST(EventEncoder, ContinuesLayersAfterResubscription) {
    Growing session(1);
    session.scan(0);
    EventEncoder encoder("tag");
    encoder.set_subscription(subscription_of({{wire::LiveLayer::kHimm}, false}));
    LiveReplay viewer;
    viewer.take(wire::encode(*encoder.next(session.snapshot())));
    EXPECT_THAT(viewer.tiles, ElementsAre(testing::Key(v1::LAYER_HIMM)));
    EXPECT_FALSE(viewer.robots.at(0).scan.has_origin());

    session.scan(0);
    encoder.set_subscription(Subscription{});
    const SessionSnapshot snapshot = session.snapshot();
    viewer.take(wire::encode(*encoder.next(snapshot)));
    viewer.expect_equal_to(*snapshot.maps, snapshot.connected);
    EXPECT_TRUE(viewer.robots.at(0).scan.has_origin());
}

TEST(EventEncoder, SendsScanAgainAfterSubscriptionToPoints) {
    Growing session(1);
    session.scan(0);
    EventEncoder encoder("tag");
    encoder.set_subscription({{}, false});
    EXPECT_FALSE(encoder.next(session.snapshot())->robots.at(0).scan);
    for (int n = 0; n < 2; ++n) {
        encoder.set_subscription({{}, false});
        EXPECT_FALSE(encoder.next(session.snapshot()));
        encoder.set_subscription({{}, true});
        const auto event = encoder.next(session.snapshot());
        ASSERT_TRUE(event);
        EXPECT_TRUE(event->robots.at(0).scan);
    }
}

TEST(EventEncoder, SendsStateChangeWithReason) {
    Growing session(1);
    EventEncoder encoder("tag");
    SessionSnapshot snapshot = session.snapshot();
    EXPECT_EQ(encoder.next(snapshot)->state, wire::LiveState::kOk);
    snapshot.state = wire::LiveState::kDraining;
    snapshot.reason = "the server is shutting down";
    const auto event = encoder.next(snapshot);
    EXPECT_EQ(event->state, wire::LiveState::kDraining);
    EXPECT_EQ(event->reason, snapshot.reason);
    EXPECT_EQ(encoder.next(snapshot), std::nullopt);
}

TEST(EventEncoder, SendsChangedBodyRadius) {
    Growing session(2);
    EventEncoder encoder("tag");
    const auto sent = [&] {
        v1::LiveEvent event;
        EXPECT_TRUE(event.ParseFromString(wire::encode(encoder.next(session.snapshot()).value())));
        return event;
    };
    EXPECT_EQ(sent().robots(0).body_radius(), 0.0) << "not stated";
    for (const double radius : {0.25, 0.5}) {
        session.apply(RobotJoined{1, "r1", "", radius});
        const auto event = sent();
        ASSERT_EQ(event.robots_size(), 1);
        EXPECT_EQ(event.robots(0).robot(), 1U);
        EXPECT_EQ(event.robots(0).body_radius(), radius);
    }
    EXPECT_EQ(encoder.next(session.snapshot()), std::nullopt);
}

/// Returns the maps with all poses moved by a metre along x, as if they had been corrected at the newest entry.
mapping::Snapshot moved(mapping::Snapshot maps) {
    for (auto& robot : maps.robots) {
        mapping::Trajectory trail;
        for (std::size_t n = 0; n < robot.trajectory.size(); ++n) {
            auto point = robot.trajectory[n];
            point.pose.x += 1.0;
            trail.append(point);
        }
        robot.trajectory = trail.snapshot();
        robot.pose = robot.trajectory[robot.trajectory.size() - 1].pose;
        auto newest = *robot.newest_scan;
        newest.scan.pose = robot.pose;
        robot.newest_scan = std::make_shared<const mapping::IntegratedScan>(std::move(newest));
    }
    maps.scan_poses = mapping::ScanPoses({}, maps.revision);
    return maps;
}

TEST(EventEncoder, SendsAllTrailsAndScansAgainAfterPosesWereCorrected) {
    Growing session(2);
    for (int n = 0; n < 40; ++n) session.scan(static_cast<RobotIndex>(n % 2));
    EventEncoder encoder("tag");
    LiveReplay viewer;
    viewer.take(wire::encode(*encoder.next(session.snapshot())));
    EXPECT_EQ(viewer.last.poses_corrected(), 0U);

    SessionSnapshot corrected = session.snapshot();
    corrected.maps = std::make_shared<const mapping::Snapshot>(moved(session.maps()));
    viewer.take(wire::encode(encoder.next(corrected).value()));
    EXPECT_EQ(viewer.last.poses_corrected(), corrected.maps->revision);
    EXPECT_EQ(viewer.last.robots(0).trail_from(), 0U);
    EXPECT_EQ(viewer.robots.at(1).trail.size(), 20U);
    ASSERT_NO_FATAL_FAILURE(viewer.expect_equal_to(*corrected.maps, corrected.connected));
    EXPECT_EQ(encoder.next(corrected), std::nullopt);
}

TEST(EventEncoder, SendsNewestPointsOfLongTrailAfterPosesWereCorrected) {
    Growing session(1);
    for (int n = 0; n < 300; ++n) session.scan(0);
    EventEncoder encoder("tag");
    static_cast<void>(encoder.next(session.snapshot()));
    SessionSnapshot corrected = session.snapshot();
    corrected.maps = std::make_shared<const mapping::Snapshot>(moved(session.maps()));
    const auto event = encoder.next(corrected);
    EXPECT_EQ(event->robots.at(0).trail.size(), kTrailMax);
    EXPECT_EQ(event->robots.at(0).trail_from, 300 - kTrailMax);
}

TEST(EventEncoder, SendsLocalizationWhenStateOrQualityChanges) {
    using State = LocalizationState;
    Growing session(2);
    session.apply(RobotJoined{.robot = 2, .name = "r2", .poses = Poses::kNone});
    EventEncoder encoder("tag");
    mapping::Localization known;
    const auto next = [&]() -> std::optional<v1::LiveEvent> {
        auto maps = session.maps();
        maps.robots[2].localization = known;
        SessionSnapshot snapshot = session.snapshot();
        snapshot.maps = std::make_shared<const mapping::Snapshot>(std::move(maps));
        const auto event = encoder.next(snapshot);
        if (!event) return std::nullopt;
        v1::LiveEvent sent;
        EXPECT_TRUE(sent.ParseFromString(wire::encode(*event)));
        return sent;
    };
    known = {.state = State::kTracking, .inlier_ratio = 0.75, .position_sigma = 0.03125, .yaw_sigma = 0.0625};
    auto event = next();
    ASSERT_EQ(event->robots_size(), 3);
    EXPECT_FALSE(event->robots(1).has_localization()) << "it sends poses in the map frame";
    const auto sent = event->robots(2).localization();
    EXPECT_EQ(sent.state(), v1::LOCALIZATION_STATE_TRACKING);
    EXPECT_EQ(sent.poses(), v1::POSES_NONE);
    EXPECT_EQ(sent.inliers(), 0.75F);
    EXPECT_EQ(sent.sigma_m(), 0.03125F);
    EXPECT_EQ(sent.sigma_rad(), 0.0625F);
    EXPECT_EQ(sent.mount_yaw_error(), 0.0F);

    known.position_sigma = 0.033;
    known.inlier_ratio = 0.76;
    EXPECT_FALSE(next()) << "hardly another quality";
    for (const auto& change : {mapping::Localization{State::kLost, 0.76, 0.033, 0.0625},
                               mapping::Localization{State::kLost, 0.36, 0.033, 0.0625},
                               mapping::Localization{State::kLost, 0.36, 0.133, 0.0625},
                               mapping::Localization{State::kUnlocated, 0.36, 0.133, 0.0875}}) {
        known = change;
        event = next();
        ASSERT_TRUE(event);
        ASSERT_EQ(event->robots_size(), 1);
        EXPECT_EQ(event->robots(0).localization().inliers(), static_cast<float>(change.inlier_ratio));
    }
    EXPECT_EQ(event->robots(0).localization().state(), v1::LOCALIZATION_STATE_UNLOCATED);
    known.mount_yaw_error = -3.0;
    event = next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->robots(0).localization().mount_yaw_error(), -3.0F);
    known.mount_yaw_error = -2.98;
    EXPECT_FALSE(next());
}

TEST(EventEncoder, SendsEventIfOnlyMovingScansChanged) {
    Growing session(1);
    session.scan(0);
    EventEncoder encoder("tag");
    static_cast<void>(encoder.next(session.snapshot()));
    for (const std::uint64_t moving : {1U, 0U}) {
        auto maps = session.maps();
        maps.moving_scans = moving;
        SessionSnapshot snapshot = session.snapshot();
        snapshot.maps = std::make_shared<const mapping::Snapshot>(std::move(maps));
        v1::LiveEvent event;
        ASSERT_TRUE(event.ParseFromString(wire::encode(encoder.next(snapshot).value())));
        EXPECT_EQ(event.moving_scans(), moving);
        EXPECT_EQ(event.robots_size(), 0);
    }
}

TEST(EventEncoder, SendsEventIfOnlyGoalsChanged) {
    Growing session(1);
    session.scan(0);
    EventEncoder encoder("tag");
    SessionSnapshot snapshot = session.snapshot();
    EXPECT_EQ(encoder.next(snapshot)->goals_revision, 0U);
    snapshot.goals_revision = 3;
    EXPECT_EQ(encoder.next(snapshot)->goals_revision, 3U);
    EXPECT_EQ(encoder.next(snapshot), std::nullopt);
    session.scan(0);
    SessionSnapshot later = session.snapshot();
    later.goals_revision = 3;
    v1::LiveEvent event;
    ASSERT_TRUE(event.ParseFromString(wire::encode(*encoder.next(later))));
    EXPECT_EQ(event.goals_revision(), 3U) << "in every event";
}

TEST(EventEncoder, BoundsEventForAnyNumberOfRobots) {
    constexpr std::uint32_t kRobots = 1024;
    mapping::Snapshot maps{.revision = 9};
    const auto sensor =
        std::make_shared<const Sensor>(Sensor{.angles = UniformAngles{0.0, 0.001, 4096}, .range_max = 1000.0});
    Scan scan{.pose = Pose2{}};
    scan.ranges.assign(4096, 999'999);
    const auto newest = std::make_shared<const mapping::IntegratedScan>(mapping::IntegratedScan{9, sensor, scan});
    mapping::Trajectory trail;
    for (int n = 0; n < 1000; ++n) trail.append({1, 0.0, {n % 2 == 0 ? 1e6 : -1e6, n % 2 == 0 ? -1e6 : 1e6, 0.0}});
    for (std::uint32_t n = 0; n < kRobots; ++n) {
        maps.robots.push_back({.name = std::string(64, 'r'),
                               .scan_count = 1000,
                               .pose = Pose2{},
                               .trajectory = trail.snapshot(),
                               .newest_scan = newest});
    }
    EventEncoder encoder("tag");
    const auto event = encoder.next({std::make_shared<const mapping::Snapshot>(maps), {}, wire::LiveState::kOk, {}});
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

TEST(ScanPoints, AreEndPointsOfBeamsThatHit) {
    Sensor sensor{.id = 3,
                  .mount = {1.0, 0.0, 0.0},
                  .angles = UniformAngles{0.0, std::numbers::pi / 2, 4},
                  .range_min = 0.5,
                  .range_max = 10.0};
    Scan scan;
    scan.stamp = 7.5;
    scan.pose = {5.0, 5.0, std::numbers::pi / 2};
    scan.ranges = {2'000, 3'000, kNoReturn, kInvalidRange};
    const mapping::IntegratedScan applied{1, std::make_shared<const Sensor>(sensor), scan};
    const auto points = points_of(applied, 1);
    EXPECT_NEAR(points.origin.x, 5.0, 1e-9);
    EXPECT_NEAR(points.origin.y, 6.0, 1e-9);
    EXPECT_THAT(points.points, ElementsAre(PointMm{0, 2'000}, PointMm{-3'000, 0}));
    EXPECT_EQ(points.stamp, 7.5);

    scan.ranges = {400, 10'000, 1'000, 9'999}; // nearer than range_min, farther than range_max
    const mapping::IntegratedScan bounds{1, std::make_shared<const Sensor>(sensor), scan};
    EXPECT_THAT(points_of(bounds, 1).points, ElementsAre(PointMm{0, -1'000}, PointMm{9'999, 0}));
    EXPECT_THAT(points_of(bounds, 2).points, ElementsAre(PointMm{0, -1'000}));
}

} // namespace
} // namespace scanloom::live
