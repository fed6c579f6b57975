#include "tests/integration/requests_fixture.hpp"

#include "core/classify/frontiers.hpp"
#include "core/planning/grid_path.hpp"
#include "server/guidance/robots.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

/// Robots that request paths, goals and coverage.
namespace scanloom::ingest {
namespace {

TEST_F(RequestsTest, APlanIsThePathOfThePlanner) {
    auto& ingest = start();
    const auto robot = looking_around("r");
    robot->send(wire::PlanRequest{.id = 7, .start = Point2{1.0, 1.0}, .goal = {2.5, 0.2}, .body_radius = 0.2});
    const auto reply = robot->receive_kind<wire::PlanReply>();
    const auto maps = ingest.snapshot("lab");
    planning::PassabilityOptions options;
    options.body_radius_m = 0.2;
    const auto expected = planning::plan_path(maps->classes, 0.05, {1.0, 1.0}, {2.5, 0.2}, options).value();
    EXPECT_EQ(reply.id, 7U);
    EXPECT_EQ(reply.revision, 3U);
    EXPECT_EQ(reply.result.value(), (wire::Path{expected.points, expected.length_m, expected.cost}));
}

TEST_F(RequestsTest, WithoutAStartTheNewestPoseIsUsed) {
    start();
    const auto robot = looking_around("r");
    robot->send(plan_to({2.5, 0.2}));
    EXPECT_EQ(robot->receive_kind<wire::PlanReply>().result.value().points.front(), (Point2{0.5, 1.25}));
    const auto mute = welcomed(port(), hello("mute"));
    mute->send(plan_to({2.5, 0.2}));
    EXPECT_EQ(mute->receive_kind<wire::PlanReply>().result.error().code, Errc::kNoPath);
    mute->send(wire::GoalRequest{});
    EXPECT_THAT(mute->receive_kind<wire::GoalReply>().result.error().message, testing::HasSubstr("'mute'"));
    mute->send(wire::CoverageRequest{});
    EXPECT_EQ(mute->receive_kind<wire::CoverageReply>().result.error().code, Errc::kNoPath);
}

TEST_F(RequestsTest, PathsFitTheBodyRadiusOfTheHello) {
    start();
    auto stated = hello("r");
    stated.body_radius = 0.5;
    const auto robot = welcomed(port(), stated);
    robot->send(half_round_laser());
    robot->send(wire::ScanBatch{{scan_with_a_gap()}});
    robot->wait_for_ack(1);
    robot->send(plan_to({3.2, 1.25}));
    const auto refused = robot->receive_kind<wire::PlanReply>();
    EXPECT_THAT(refused.result.error().message, testing::HasSubstr("than the body radius of 0.5 m"));
    robot->send(wire::PlanRequest{.id = 2, .goal = {3.2, 1.25}, .body_radius = 0.1});
    EXPECT_TRUE(robot->receive_kind<wire::PlanReply>().result);
    robot->send(wire::GoalRequest{.id = 3});
    robot->send(wire::GoalRequest{.id = 4, .body_radius = 0.5});
    const auto own = robot->receive_kind<wire::GoalReply>().result.value();
    EXPECT_EQ(own.target, robot->receive_kind<wire::GoalReply>().result.value().target);
    robot->send(wire::CoverageRequest{.id = 5});
    robot->send(wire::CoverageRequest{.id = 6, .body_radius = 0.5});
    const auto coverage = robot->receive_kind<wire::CoverageReply>().result.value();
    EXPECT_EQ(coverage, robot->receive_kind<wire::CoverageReply>().result.value());
}

TEST_F(RequestsTest, TheLastPlanIsKeptUntilTheRobotLeaves) {
    auto& ingest = start();
    const auto robot = looking_around("r");
    const auto session = ingest.sessions().find("lab");
    const auto page = [&] { return ingest.goals().paths().page(session, guidance::RobotPaths::Clock::now()); };
    robot->send(plan_to({2.5, 0.2}));
    const auto plan = robot->receive_kind<wire::PlanReply>();
    ASSERT_EQ(page().robots.size(), 1U);
    EXPECT_EQ(page().robots[0].path->kind, guidance::PathKind::kPlan);
    EXPECT_EQ(page().robots[0].path->points, plan.result.value().points);
    EXPECT_EQ(page().robots[0].path->length_m, plan.result.value().length);
    EXPECT_EQ(page().robots[0].path->revision, plan.revision);

    robot->send(wire::CoverageRequest{.id = 2});
    const auto coverage = robot->receive_kind<wire::CoverageReply>();
    EXPECT_EQ(page().robots[0].path->kind, guidance::PathKind::kCoverage);
    EXPECT_EQ(page().robots[0].path->points, coverage.result.value().path.points);

    robot->send(wire::GoalRequest{.id = 3, .frontier_size_min = 10});
    const auto goal = robot->receive_kind<wire::GoalReply>();
    EXPECT_EQ(page().robots[0].goal->target, goal.result.value().target);
    EXPECT_EQ(page().robots[0].path->points, goal.result.value().path->points);

    robot->send(plan_to({3.53, 1.25})); // inside a wall
    EXPECT_FALSE(robot->receive_kind<wire::PlanReply>().result);
    EXPECT_TRUE(page().robots[0].goal);
    EXPECT_EQ(page().robots[0].path, nullptr);

    robot->send(wire::Goodbye{});
    EXPECT_FALSE(robot->receive().has_value());
    while (session->is_connected(0)) std::this_thread::yield();
    EXPECT_THAT(page().robots, testing::IsEmpty());
}

TEST_F(RequestsTest, TheGoalOfARobotThatIsLostIsTakenBack) {
    auto& ingest = start();
    auto greeting = hello("r");
    greeting.poses = Poses::kNone;
    const auto robot = welcomed(port(), greeting);
    robot->send(half_round_laser());
    const auto send_scan = [&](std::uint64_t seq, auto change) {
        Scan scan = scan_with_a_gap(seq);
        scan.pose.reset();
        change(scan);
        robot->send(wire::ScanBatch{{scan}});
        robot->wait_for_ack(seq);
    };
    send_scan(1, [](Scan&) {});
    robot->send(wire::GoalRequest{.id = 1});
    EXPECT_TRUE(robot->receive_kind<wire::GoalReply>().result);
    const auto goals = [&] {
        return ingest.goals().paths().page(ingest.sessions().find("lab"), guidance::RobotPaths::Clock::now());
    };
    EXPECT_EQ(goals().robots.size(), 1U);
    for (std::uint64_t seq = 2; seq < 32; ++seq) {
        send_scan(seq, [seq](Scan& scan) { // the laser is covered
            for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
                scan.ranges[k] = static_cast<RangeMm>(300 + 97 * (k * k + seq) % 400);
            }
        });
    }
    while (ingest.snapshot("lab")->robots.at(0).localization.state != LocalizationState::kLost) {
        std::this_thread::yield();
    }
    robot->send(wire::GoalRequest{.id = 2});
    const auto refused = robot->receive_kind<wire::GoalReply>();
    EXPECT_EQ(refused.result.error().code, Errc::kNoPath);
    EXPECT_THAT(refused.result.error().message, testing::HasSubstr("it is lost"));
    EXPECT_THAT(goals().robots, testing::IsEmpty());
}

TEST_F(RequestsTest, UnsatisfiableRequestsAreRefusedAndTheLinkContinues) {
    start();
    const auto robot = looking_around("r");
    robot->send(plan_to({3.53, 1.25}));
    const auto blocked = robot->receive_kind<wire::PlanReply>();
    EXPECT_EQ(blocked.result.error().code, Errc::kNoPath);
    EXPECT_THAT(blocked.result.error().message, testing::HasSubstr("inside an obstacle"));
    robot->send(wire::PlanRequest{.id = 2, .goal = {2.5, 0.2}, .body_radius = -1.0});
    const auto bad = robot->receive_kind<wire::PlanReply>();
    EXPECT_EQ(bad.result.error().code, Errc::kInvalidField);
    EXPECT_THAT(bad.result.error().message, testing::StartsWith("body_radius is -1 m"));
    robot->send(wire::CoverageRequest{.id = 3, .spacing = 9.0});
    EXPECT_EQ(robot->receive_kind<wire::CoverageReply>().result.error().code, Errc::kInvalidField);
    robot->send(wire::ScanBatch{{scan_with_a_gap(2)}});
    robot->wait_for_ack(2);
}

TEST_F(RequestsTest, TwoRobotsNeverGetTheSameFrontierOverAnyPort) {
    auto& ingest = start();
    const auto frontier_of = [&](const Point2& target) {
        const auto frontiers = classify::find_frontiers(ingest.snapshot("lab")->classes, 10);
        const grid::Cell cell{static_cast<std::int32_t>(std::floor(target.x / 0.05)),
                              static_cast<std::int32_t>(std::floor(target.y / 0.05))};
        return std::ranges::find_if(
                   frontiers, [&](const auto& one) { return std::ranges::find(one.cells, cell) != one.cells.end(); }) -
               frontiers.begin();
    };
    const auto first = looking_around("a");
    const auto second = looking_around("b");
    first->send(wire::GoalRequest{.id = 1, .frontier_size_min = 10});
    const auto goal = first->receive_kind<wire::GoalReply>().result.value();
    ASSERT_EQ(goal.exploration, wire::Exploration::kGoal);
    EXPECT_EQ(goal.path->points.front(), (Point2{0.5, 1.25}));

    // Robot b uses HTTP.
    const auto session = ingest.sessions().find("lab");
    const auto maps = session->snapshot();
    planning::ExplorationOptions options;
    options.frontier_size_min = 10;
    const auto other = ingest.goals()
                           .next(session, *maps, guidance::find_robot(*maps, "b").value(), {0.5, 1.25},
                                 guidance::GoalAssignments::Clock::now(), options)
                           .value();
    ASSERT_TRUE(other.goal);
    const Point2 target = Point2{other.goal->target.i + 0.5, other.goal->target.j + 0.5} * 0.05;
    EXPECT_NE(frontier_of(target), frontier_of(*goal.target));

    std::set<std::ptrdiff_t> given = {frontier_of(target), frontier_of(*goal.target)};
    std::vector<std::unique_ptr<RobotSocket>> others;
    for (int n = 0;; ++n) {
        others.push_back(looking_around("c" + std::to_string(n)));
        others.back()->send(wire::GoalRequest{.id = 9, .frontier_size_min = 10});
        const auto next = others.back()->receive_kind<wire::GoalReply>().result.value();
        if (next.exploration != wire::Exploration::kGoal) {
            EXPECT_EQ(next.exploration, wire::Exploration::kTakenByOthers);
            break;
        }
        ASSERT_TRUE(given.insert(frontier_of(*next.target)).second);
    }
}

TEST_F(RequestsTest, UnobservableFrontiersAreExcluded) {
    start();
    const auto robot = looking_around("r");
    robot->send(wire::GoalRequest{.id = 1});
    const auto goal = robot->receive_kind<wire::GoalReply>().result.value();
    ASSERT_TRUE(goal.path && goal.target);
    EXPECT_EQ(goal.given_up, 0U);
    const Point2 place = goal.path->points.back();
    const Point2 ahead = *goal.target - place;
    Scan blind = scan_with_a_gap(2);
    blind.pose = {place.x, place.y, std::atan2(ahead.y, ahead.x)};
    std::ranges::fill(blind.ranges, kInvalidRange);
    robot->send(wire::ScanBatch{{blind}});
    robot->wait_for_ack(2);
    robot->send(wire::GoalRequest{.id = 2});
    const auto next = robot->receive_kind<wire::GoalReply>().result.value();
    EXPECT_GT(next.given_up, 0U);
    EXPECT_NE(next.target, goal.target);
}

TEST_F(RequestsTest, CoverageReachesTheGroundOfItsRegion) {
    start();
    const auto robot = looking_around("r");
    robot->send(wire::CoverageRequest{.id = 5, .region = {{1.0, 0.5}, {2.0, 0.5}, {2.0, 1.5}, {1.0, 1.5}}});
    const auto reply = robot->receive_kind<wire::CoverageReply>();
    EXPECT_EQ(reply.id, 5U);
    const auto coverage = reply.result.value();
    EXPECT_NEAR(coverage.free_area, 1.0, 0.1);
    EXPECT_NEAR(coverage.covered_area, coverage.free_area, 0.1);
    EXPECT_EQ(coverage.path.points.front(), (Point2{0.5, 1.25}));
    EXPECT_GT(coverage.path.length, 3.0);

    robot->send(wire::CoverageRequest{.id = 6});
    const auto everywhere = robot->receive_kind<wire::CoverageReply>().result.value();
    EXPECT_EQ(everywhere.cell_size, 0.05);
    double cells = 0.0;
    for (const auto& run : everywhere.unreachable) cells += run.count;
    EXPECT_GT(cells, 0.0) << "the path leaves out cells next to walls and unknown cells";
    EXPECT_NEAR(everywhere.covered_area + cells * 0.05 * 0.05, everywhere.free_area, 1e-9);
}

TEST_F(RequestsTest, RequestsUseTheMapsOfTheRobotsSession) {
    start();
    const auto here = looking_around("r", "here");
    const auto elsewhere = welcomed(port(), hello("r", "elsewhere"));
    elsewhere->send(wire::PlanRequest{.id = 1, .start = Point2{1.0, 1.0}, .goal = {2.5, 0.2}});
    EXPECT_THAT(elsewhere->receive_kind<wire::PlanReply>().result.error().message,
                testing::HasSubstr("outside the map"));
}

} // namespace
} // namespace scanloom::ingest
