#include "server/guidance/goal_assignments.hpp"
#include "sim/ground_truth.hpp"
#include "sim/simulator.hpp"
#include "tests/support/exploring_robot.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <map>
#include <numbers>
#include <optional>
#include <ostream>
#include <tuple>
#include <vector>

/// Robots that drive to the server's goals until nothing is left to explore.
namespace scanloom::guidance {
namespace {

using planning::Exploration;
using testing_support::ExploringRobot;

constexpr double kCellSize = 0.05;
constexpr double kRange = 5.0;
constexpr int kGoalsMax = 100; // the largest number in the runs below is 42

/// Avoids walls exactly on cell borders.
const Point2 kMiddle{0.137, 0.163};

sim::World moved(const sim::World& world) {
    const auto move = [](std::vector<sim::Box> boxes) {
        for (sim::Box& box : boxes) {
            box = {box.x_min + kMiddle.x, box.y_min + kMiddle.y, box.x_max + kMiddle.x, box.y_max + kMiddle.y};
        }
        return boxes;
    };
    return sim::make_world(world.name, move(world.solids), move(world.floors));
}

sim::World furnished_room() { return moved(sim::make_room()); }

/// A corridor, two rooms above and three below it, with doors of 0.9 m and some furniture. 10 x 8 m inside.
sim::World five_rooms() {
    return moved(sim::make_world("five_rooms",
                                 {
                                     // shell
                                     {-0.2, -0.2, 10.2, 0.0},
                                     {-0.2, 8.0, 10.2, 8.2},
                                     {-0.2, -0.2, 0.0, 8.2},
                                     {10.0, -0.2, 10.2, 8.2},
                                     // below the corridor: doors at 1.5, 5.2 and 8.5
                                     {0.0, 2.85, 1.05, 3.0},
                                     {1.95, 2.85, 4.75, 3.0},
                                     {5.65, 2.85, 8.05, 3.0},
                                     {8.95, 2.85, 10.0, 3.0},
                                     {3.4, 0.0, 3.55, 3.0},
                                     {6.9, 0.0, 7.05, 3.0},
                                     // above it: doors at 3 and 7
                                     {0.0, 4.6, 2.55, 4.75},
                                     {3.45, 4.6, 6.55, 4.75},
                                     {7.45, 4.6, 10.0, 4.75},
                                     {4.9, 4.6, 5.05, 8.0},
                                     // a desk, a cupboard, a table, a shelf
                                     {0.0, 0.0, 1.6, 0.7},
                                     {4.2, 1.0, 5.2, 1.6},
                                     {1.4, 6.0, 2.6, 6.8},
                                     {9.5, 5.5, 10.0, 7.5},
                                 },
                                 {{0.0, 3.0, 10.0, 4.6}}));
}

Sensor laser(bool all_round) {
    Sensor sensor;
    sensor.id = 1;
    sensor.angles = all_round ? UniformAngles{-std::numbers::pi, std::numbers::pi / 360, 720}
                              : UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 360, 361};
    sensor.range_min = 0.02;
    sensor.range_max = kRange;
    return sensor;
}

std::optional<sim::Noise> range_noise(bool noisy) {
    if (!noisy) return std::nullopt;
    return sim::Noise{.range = 0.02, .beam_angle = 0.0};
}

/// Returns the known part of the free cells of a perfect map.
double known_share(const sim::World& world, const classify::ClassView& classes) {
    const auto truth = sim::ground_truth_of(world, kCellSize);
    int free = 0;
    int known = 0;
    for (std::int32_t j = truth.j_begin; j < truth.j_begin + truth.height; ++j) {
        for (std::int32_t i = truth.i_begin; i < truth.i_begin + truth.width; ++i) {
            if (truth.at(i, j) != sim::GroundTruth::kFree) continue;
            const auto found = class_at(classes, {i, j});
            free += 1;
            known += found != classify::CellClass::kUnexplored && found != classify::CellClass::kFrontier ? 1 : 0;
        }
    }
    return static_cast<double>(known) / free;
}

class ExplorationTest : public sessions::SessionTest {
protected:
    /// Lets the robots explore until the server has reported a complete map to each of them.
    void explore(const sim::World& world, std::vector<ExploringRobot> robots) {
        mapping::Projection maps(mapping::resolve({}).value());
        GoalAssignments book;
        std::vector<bool> ended(robots.size());
        goals_ = 0;
        given_.clear();
        targets_.assign(robots.size(), {});
        for (auto& robot : robots) robot.join(maps);
        while (std::ranges::find(ended, false) != ended.end()) {
            ASSERT_LT(goals_, kGoalsMax);
            for (RobotIndex n = 0; n < robots.size(); ++n) {
                if (!ended[n] && robots[n].has_arrived()) ended[n] = !ask(book, maps, n, robots[n]);
                if (!robots[n].has_arrived()) robots[n].step(maps);
                ASSERT_GE(robots[n].least_clearance(), sim::kBodyRadius - kCellSize);
            }
            if (HasFatalFailure()) return;
        }
        EXPECT_GE(known_share(world, maps.snapshot().classes), 0.95);
    }

private:
    using Given = std::tuple<RobotIndex, int, int, int, int>; // a goal and a target

    /// @return whether the robot has another goal
    bool ask(GoalAssignments& book, mapping::Projection& projection, RobotIndex index, ExploringRobot& robot) {
        const auto maps = projection.snapshot();
        targets_[index].clear();
        const auto next = book.next(session_, maps, index, robot.place(), {});
        if (!next) {
            ADD_FAILURE() << next.error().message;
            return false;
        }
        if (!next->goal) return next->outcome == Exploration::kTakenByOthers;
        goals_ += 1;
        expect_other_goal({index, next->goal->cell.i, next->goal->cell.j, next->goal->target.i, next->goal->target.j},
                          maps.classes);
        targets_[index] = next->around_target;
        for (RobotIndex other = 0; other < targets_.size(); ++other) {
            for (const grid::Cell cell : targets_[other]) {
                EXPECT_TRUE(other == index || cell != next->goal->target) << "one frontier for two robots";
            }
        }
        const grid::Cell target = next->goal->target;
        robot.go(next->path.points, Point2{target.i + 0.5, target.j + 0.5} * kCellSize);
        return true;
    }

    void expect_other_goal(const Given& given, const classify::ClassView& classes) {
        constexpr auto kEnd = std::int64_t{1} << 31;
        const auto newest = classes.newest({-kEnd, -kEnd, kEnd, kEnd});
        auto& given_at = given_[given];
        EXPECT_LT(given_at, newest) << "the same goal was returned twice for an unchanged map";
        given_at = newest;
    }

    int goals_ = 0;                                // of all robots
    std::map<Given, Revision> given_;              // revision of the map when the goal was returned last
    std::vector<std::vector<grid::Cell>> targets_; // of each robot, while it drives there
};

struct Case {
    const char* name;
    sim::World (*world)();
    bool all_round;
    bool noisy;
    std::vector<Pose2> starts;

    friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

class ExploringAlone : public ExplorationTest, public testing::WithParamInterface<Case> {};

TEST_P(ExploringAlone, EndsWithACompleteMap) {
    const auto world = GetParam().world();
    for (const Pose2& start : GetParam().starts) {
        SCOPED_TRACE(testing::Message() << "from " << start.x << ", " << start.y);
        explore(world, {{0, world, laser(GetParam().all_round), start, range_noise(GetParam().noisy)}});
    }
}

const std::vector<Pose2> kInTheRoom = {{-3.5, -3.3, 0.0}, {3.4, 3.1, 2.0}, {0.1, -3.6, -1.5}};
const std::vector<Pose2> kInTheRooms = {{1.0, 3.9, 0.0}, {9.0, 1.5, 1.5}, {1.0, 7.4, -3.0}};

INSTANTIATE_TEST_SUITE_P(Worlds, ExploringAlone,
                         testing::Values(Case{"RoomAllRound", furnished_room, true, false, kInTheRoom},
                                         Case{"RoomAllRoundNoisy", furnished_room, true, true, kInTheRoom},
                                         Case{"RoomAhead", furnished_room, false, false, kInTheRoom},
                                         Case{"RoomAheadNoisy", furnished_room, false, true, kInTheRoom},
                                         Case{"RoomsAllRound", five_rooms, true, false, kInTheRooms},
                                         Case{"RoomsAllRoundNoisy", five_rooms, true, true, kInTheRooms},
                                         Case{"RoomsAhead", five_rooms, false, false, kInTheRooms},
                                         Case{"RoomsAheadNoisy", five_rooms, false, true, kInTheRooms}),
                         [](const auto& one) { return one.param.name; });

TEST_F(ExplorationTest, TwoRobotsFinishAndNeverShareAFrontier) {
    const auto world = five_rooms();
    for (const bool all_round : {true, false}) {
        explore(world, {{0, world, laser(all_round), {1.0, 3.9, 0.0}, range_noise(true)},
                        {1, world, laser(all_round), {9.0, 1.5, 1.5}, range_noise(true)}});
    }
}

} // namespace
} // namespace scanloom::guidance
