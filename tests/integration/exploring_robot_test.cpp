#include "sim/ground_truth.hpp"
#include "sim/simulator.hpp"
#include "tests/support/goal_oracle.hpp"
#include "tests/support/unexplored.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>

#include <algorithm>
#include <exception>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

/// Simulated robots that explore with the goals of a server in the same process, until nothing is left.
namespace scanloom::robot {
namespace {

using testing_support::GoalOracle;
using testing_support::Unexplored;

constexpr std::uint64_t kSeedsPerCase = 5; // so that cases can run in parallel
constexpr sim::SimulationLimits kLimits{.duration = 3600.0};

/// Returns the known part of the free cells of a perfect map.
double known_share(const sim::World& world, const mapping::Snapshot& maps) {
    const auto truth = ground_truth_of(world, maps.config.cell_size);
    int free = 0;
    int known = 0;
    for (std::int32_t j = truth.j_begin; j < truth.j_begin + truth.height; ++j) {
        for (std::int32_t i = truth.i_begin; i < truth.i_begin + truth.width; ++i) {
            if (truth.at(i, j) != sim::GroundTruth::kFree) continue;
            const auto found = class_at(maps.classes, {i, j});
            free += 1;
            known += found != classify::CellClass::kUnexplored && found != classify::CellClass::kFrontier ? 1 : 0;
        }
    }
    return static_cast<double>(known) / free;
}

/// Returns the area that the robot could still explore.
std::vector<grid::Cell> left_unexplored(const sim::World& world, GoalOracle& oracle, RobotIndex index) {
    const auto maps = oracle.maps();
    const Pose2 robot =
        maps.robots.at(index).pose.value(); // by the map, which differs from the world if it is estimated
    const auto truth = ground_truth_of(world, maps.config.cell_size);
    constexpr std::int32_t kMargin = 40; // cells; noisy readings end behind walls
    const grid::CellBox area{truth.i_begin - kMargin, truth.j_begin - kMargin, truth.i_begin + truth.width + kMargin,
                             truth.j_begin + truth.height + kMargin};
    // the width of the requested paths: 2 * 0.22 m over cells of 0.05 m along their diagonals
    const auto size_min =
        static_cast<std::size_t>(2.0 * sim::Explore::kPathClearance / (std::numbers::sqrt2 * maps.config.cell_size));
    const Unexplored unexplored(maps.classes, area,
                                {.cell_size = maps.config.cell_size,
                                 .clearance = sim::Explore::kPathClearance,
                                 .size_min = size_min,
                                 .looked_at = oracle.looked_at()});
    EXPECT_GT(unexplored.reach({robot.x, robot.y}), 1000) << "the check itself reaches most of the office";
    return unexplored.within_reach_of({robot.x, robot.y});
}

/// A robot whose scans go to the oracle, which returns its goals.
class Explorer {
public:
    /// @param is_corrected  whether the robot takes the corrections of a server that estimates its poses
    Explorer(GoalOracle& oracle, RobotIndex index, const sim::SimulatorOptions& options, bool is_corrected = false)
        : oracle_(oracle), index_(index), is_corrected_(is_corrected), source_(options, kLimits, NoReturn::kFree, 0.0) {
        oracle_.join(index_, *source_.simulator().sensors().front(), options.poses);
        source_.ask_with([this]() -> boost::asio::awaitable<Result<NextStop>> { co_return oracle_.next(index_); });
    }

    /// @return whether there was a scan
    bool step() {
        std::optional<Result<std::optional<Observation>>> next;
        boost::asio::co_spawn(io_, source_.next(), [&](std::exception_ptr failed, auto result) {
            if (failed) std::rethrow_exception(failed);
            next = std::move(result);
        });
        io_.restart();
        io_.run();
        if (!*next) failure_ = next->error();
        if (!*next || !**next) return false;
        Scan scan = (**next)->scan;
        scan.seq = ++seq_;
        const auto& simulator = source_.simulator();
        clearance_min_ = std::min(clearance_min_, clearance(simulator.world(), sim::position_of(simulator.pose())));
        oracle_.take(index_, std::move(scan));
        if (is_corrected_) source_.correct(oracle_.T_map_odom(index_), LocalizationState::kTracking);
        return true;
    }

    /// Returns why the robot has given up, if it has.
    [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }
    [[nodiscard]] RobotIndex index() const { return index_; }
    [[nodiscard]] const sim::ExploringSource& source() const { return source_; }
    [[nodiscard]] double clearance_min() const { return clearance_min_; }

private:
    boost::asio::io_context io_;
    GoalOracle& oracle_;
    RobotIndex index_;
    bool is_corrected_;
    sim::ExploringSource source_;
    std::uint64_t seq_ = 0;
    std::optional<Error> failure_;
    double clearance_min_ = 10.0;
};

void expect_explored(const Explorer& robot, GoalOracle& oracle) {
    EXPECT_FALSE(robot.failure()) << robot.failure()->message;
    const auto& simulator = robot.source().simulator();
    EXPECT_TRUE(left_unexplored(simulator.world(), oracle, robot.index()).empty());
    EXPECT_EQ(robot.source().simulator().collisions(), 0U);
    EXPECT_GE(robot.clearance_min(), sim::kBodyRadius);
    EXPECT_TRUE(robot.source().remarks().starts_with("explored: no frontier is reachable with a clearance of 0.22 m, "))
        << robot.source().remarks();
}

/// One degree between beams: a third of the time of the reference laser, with the same result. (Twenty offices with
/// that laser and noise take 140 s of CPU time.)
Sensor coarse_laser() {
    Sensor laser = *sim::find_laser("reference");
    laser.angles = UniformAngles{-std::numbers::pi / 2.0, std::numbers::pi / 180.0, 181};
    return laser;
}

Sensor reference_laser() { return *sim::find_laser("reference"); }

/// It frees cells along the walls behind the robot that it showed as free before: maps that alternate.
Sensor all_round_laser() { return *sim::find_laser("lidar360"); }

struct Case {
    const char* name;
    sim::World (*world)();
    Sensor (*laser)();
    bool noisy;
    std::uint64_t first_seed;
    std::uint64_t seeds;

    friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name << "_from_" << one.first_seed; }
};

std::vector<Case> cases() {
    std::vector<Case> cases{{"hall", sim::make_hall, coarse_laser, false, 1, 1},
                            {"office_noisy", sim::make_office, reference_laser, true, 1, 2},
                            {"office_reference", sim::make_office, reference_laser, false, 1, 1},
                            {"office_all_round", sim::make_office, all_round_laser, false, 1, 1},
                            {"room_walker_all_round_noisy", sim::make_room_walker, all_round_laser, true, 17, 2},
                            {"room_noisy", sim::make_room, reference_laser, true, 1, 5},
                            {"room_walker_noisy", sim::make_room_walker, reference_laser, true, 1, 5}};
    for (std::uint64_t seed = 1; seed <= 20; seed += kSeedsPerCase) {
        cases.push_back({"room", sim::make_room, reference_laser, false, seed, kSeedsPerCase});
        cases.push_back({"room_walker", sim::make_room_walker, reference_laser, false, seed, kSeedsPerCase});
        cases.push_back({"office", sim::make_office, coarse_laser, false, seed, kSeedsPerCase});
    }
    return cases;
}

class ExploringRobots : public sessions::SessionTest {};
class ExploringRobot : public ExploringRobots, public testing::WithParamInterface<Case> {};

TEST_P(ExploringRobot, EndsWithACompleteMapAndWithoutCollisions) {
    const Case& one = GetParam();
    const sim::World world = one.world();
    for (std::uint64_t seed = one.first_seed; seed < one.first_seed + one.seeds; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        GoalOracle oracle(session_);
        Explorer robot(oracle, 0, {world, one.laser(), one.noisy ? std::optional(sim::Noise{}) : std::nullopt, seed});
        while (robot.step()) {
        }
        expect_explored(robot, oracle);
        EXPECT_GE(known_share(world, oracle.maps()), 0.95);
    }
}

INSTANTIATE_TEST_SUITE_P(Worlds, ExploringRobot, testing::ValuesIn(cases()),
                         [](const auto& one) { return testing::PrintToString(one.param); });

TEST_F(ExploringRobots, TwoRobotsExploreTheOfficeTogether) {
    const sim::World world = sim::make_office();
    GoalOracle oracle(session_);
    Explorer first(oracle, 0, {world, coarse_laser(), std::nullopt, 1, Pose2{-13.0, -3.0, 0.0}});
    Explorer second(oracle, 1, {world, coarse_laser(), std::nullopt, 2, Pose2{13.0, 3.0, 0.0}});
    int together = 0; // scans
    while (first.step() && second.step()) ++together;
    while (first.step() || second.step()) {
    }
    expect_explored(first, oracle);
    expect_explored(second, oracle);
    EXPECT_GE(known_share(world, oracle.maps()), 0.95);
    EXPECT_GT(together, 3000) << "both robots explore a part";
}

TEST_F(ExploringRobots, CorrectionsOfTheServerMakeUpForDriftingOdometry) {
    sim::SimulatorOptions options{sim::make_office(), reference_laser(), sim::with_odometry({}, 2.0), 1};
    options.pose = sim::PoseSent::kOdometry;
    options.poses = Poses::kOdometry;
    GoalOracle oracle(session_);
    Explorer robot(oracle, 0, options, true);
    int scans = 0;
    while (robot.step()) ++scans;
    expect_explored(robot, oracle);
    EXPECT_GE(known_share(options.world, oracle.maps()), 0.95);
    const Pose2 found = oracle.maps().robots[0].pose.value();
    const Pose2& truth = robot.source().simulator().pose();
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 1.0) << "beams are dense, and noisy";

    GoalOracle other(session_);
    Explorer uncorrected(other, 0, options, false);
    while (scans > 0 && uncorrected.step()) --scans; // not longer than the other one
    EXPECT_FALSE(uncorrected.source().remarks().starts_with("explored")) << uncorrected.source().remarks();
    EXPECT_LT(known_share(options.world, other.maps()), 0.5);
}

TEST_F(ExploringRobots, TheSameSeedGivesTheSameTrajectory) {
    const auto scans = [&] {
        GoalOracle oracle(session_);
        Explorer robot(oracle, 0, {sim::make_room_walker(), reference_laser(), sim::Noise{}, 7});
        std::vector<Pose2> poses;
        while (robot.step()) poses.push_back(robot.source().simulator().pose());
        return poses;
    };
    EXPECT_EQ(scans(), scans());
}

} // namespace
} // namespace scanloom::robot
