#include "sim/world.hpp"
#include "tests/support/uniform.hpp"
#include "tests/unit/core/localization/two_robots_log.hpp"
#include "tests/unit/core/slam/two_robots.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

/// How often a robot that starts anywhere is located in the map of another one, and how often at a wrong place.
namespace scanloom::slam {
namespace {

using testing_support::Building;
using testing_support::uniform;

constexpr std::uint32_t kTrials = 250;          // of each world
constexpr std::uint32_t kTrialsOfSentMaps = 60; // likewise; they integrate all scans
constexpr double kWrong = 0.6;                  // metres: with a larger error, a robot is located at a wrong place
constexpr std::array kRanges{6.0, 10.0, 16.0};

/// A building, and points of a round tour through it.
struct Place {
    Building building;
    std::vector<Point2> tour;
};

Place place_of_world(const std::string& name) {
    Place place;
    const sim::World world = sim::find_world(name).value();
    for (const auto& side : world.outlines) place.building.walls.push_back({{side.ax, side.ay}, {side.bx, side.by}});
    place.tour = sim::tour_of(name);
    return place;
}

/// Returns a corridor with six equal rooms of 5 x 5 m on one side.
Place place_of_equal_rooms() {
    constexpr int kRooms = 6;
    Place place;
    place.building.add_box(0.0, 0.0, 5.0 * kRooms, 7.4);
    for (int room = 0; room < kRooms; ++room) {
        const double x = 5.0 * room;
        if (room > 0) place.building.add_box(x - 0.1, 2.4, x + 0.1, 7.4);
        place.building.add_box(x, 2.3, x + 2.0, 2.5);
        place.building.add_box(x + 3.0, 2.3, x + 5.0, 2.5);
        place.building.add_box(x + 0.3, 6.2, x + 1.5, 7.4);
        place.building.add_box(x + 4.4, 4.0, x + 5.0, 5.5);
        for (const Point2& at : {Point2{2.5, 1.2}, {2.5, 4.0}, {3.3, 5.5}, {2.5, 4.0}, {2.5, 1.2}}) {
            place.tour.push_back({x + at.x, at.y});
        }
    }
    place.tour.push_back({5.0 * kRooms - 1.0, 1.2});
    place.tour.push_back({1.0, 1.2});
    return place;
}

double length_of(const std::vector<Point2>& points) {
    double length = 0.0;
    for (std::size_t n = 1; n < points.size(); ++n) length += norm(points[n] - points[n - 1]);
    return length;
}

/// Returns whether no wall is on the way of a robot.
bool is_passable(const Building& building, const Point2& from, const Point2& to) {
    constexpr std::array kSides{-0.1, 0.0, 0.1}; // metres from the way
    const double length = norm(to - from);
    const Point2 ahead = (1.0 / length) * (to - from);
    return std::ranges::all_of(kSides, [&](double side) {
        const Point2 start = from + side * Point2{-ahead.y, ahead.x};
        return building.range(start, {ahead.y, ahead.x}) > length + 0.1;
    });
}

/// Returns a part of a tour that begins at any of its points, in any direction, not exactly through its points.
std::vector<Point2> part_of(const Place& place, double length, std::mt19937& random) {
    constexpr int kTriesMax = 100;
    const auto& tour = place.tour;
    const auto near = [&](std::size_t n) {
        return Point2{tour[n].x + uniform(random, -0.15, 0.15), tour[n].y + uniform(random, -0.15, 0.15)};
    };
    std::size_t at = random() % tour.size();
    const std::size_t step = random() % 2 == 0 ? 1 : tour.size() - 1;
    std::vector<Point2> points{near(at)};
    for (double left = length; left > 0.0;) {
        at = (at + step) % tour.size();
        Point2 next = near(at);
        for (int tries = 0; tries < kTriesMax && !is_passable(place.building, points.back(), next); ++tries)
            next = near(at);
        const double distance = norm(next - points.back());
        points.push_back(points.back() + std::min(1.0, left / distance) * (next - points.back()));
        left -= distance;
    }
    return points;
}

/// Returns a laser all around or ahead, with one of three ranges.
Sensor any_laser(std::mt19937& random) {
    Sensor laser = Building::laser();
    laser.range_max = kRanges.at(random() % kRanges.size());
    if (random() % 3 != 0) laser.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 180.0, 360};
    return laser;
}

Drive any_drive(const Place& place, const Sensor& laser, double length, std::mt19937& random) {
    const OdometryErrors errors{uniform(random, 0.98, 1.02), uniform(random, -0.01, 0.01)};
    const auto points = part_of(place, length, random);
    return drive_along(place.building, points, errors, static_cast<std::uint32_t>(random()), laser);
}

/// A kind of place, and limits of what happens in its trials.
struct Kind {
    const char* name;
    std::size_t located_min;             ///< trials in which the second robot is located
    std::size_t located_in_sent_map_min; ///< likewise if the first robot sends its poses
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

/// When the second robot of a trial was located.
struct Answer {
    std::size_t scan = 0;
    double error = 0.0; ///< metres, of its pose there
};

using Trial = std::optional<Answer> (*)(const Drive& first, const Drive& second);

/// Both robots have odometry. The second one starts when the first has ended.
std::optional<Answer> locate_in_estimated_map(const Drive& first, const Drive& second) {
    const TwoRobots robots(first, second);
    if (!robots.located_at()) return std::nullopt;
    return Answer{*robots.located_at(), robots.error_of(*robots.located_at())};
}

/// The first robot sends its poses. The second one starts halfway of it.
std::optional<Answer> locate_in_sent_map(const Drive& first, const Drive& second) {
    localization::LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    const auto* poses = maps.poses().find(1);
    const std::size_t head_start = first.scans.size() / 2;
    for (LogEntry& entry : localization::log_of_two(first, second, head_start)) {
        double work = HUGE_VAL;
        if (!maps.apply(entry, work)) return std::nullopt;
        poses = maps.poses().find(1);
        if (poses == nullptr || poses->localization().state != LocalizationState::kTracking) continue;
        const std::size_t scan = poses->scan_count() - 1;
        const Pose2 found = poses->newest(scan);
        return Answer{scan, std::hypot(found.x - second.truth[scan].x, found.y - second.truth[scan].y)};
    }
    return std::nullopt;
}

class TwoRobotsTrials : public testing::TestWithParam<Kind> {
protected:
    /// Some trials of the office and of the equal rooms have a second robot in a part that the first one has not seen,
    /// and that looks like a part that it has seen.
    void run(Trial trial, std::uint32_t trials, std::size_t located_min) {
        const std::string name = GetParam().name;
        const Place place = name == "equal_rooms" ? place_of_equal_rooms() : place_of_world(name);
        const double round = length_of(place.tour);
        std::size_t located = 0;
        std::string wrong;
        std::size_t wrong_count = 0;
        for (std::uint32_t seed = 1; seed <= trials; ++seed) {
            std::mt19937 random(seed);
            const Sensor laser = any_laser(random);
            const Drive first = any_drive(place, laser, round * uniform(random, 0.2, 1.0), random);
            const Drive second = any_drive(place, laser, uniform(random, 8.0, 60.0), random);
            const auto answer = trial(first, second);
            if (!answer) continue;
            ++located;
            if (answer->error <= kWrong) continue;
            ++wrong_count;
            wrong += fmt::format(" seed {} at scan {} by {:.1f} m;", seed, answer->scan, answer->error);
        }
        EXPECT_GE(located, located_min) << "of " << trials;
        EXPECT_EQ(wrong_count, 0U) << "of " << located << ":" << wrong;
        RecordProperty("located", static_cast<int>(located));
        RecordProperty("wrong", static_cast<int>(wrong_count));
    }
};

TEST_P(TwoRobotsTrials, AreNeverJoinedAtAWrongPlace) { run(locate_in_estimated_map, kTrials, GetParam().located_min); }

TEST_P(TwoRobotsTrials, AreNeverJoinedAtAWrongPlaceInTheMapOfARobotThatSendsItsPoses) {
    run(locate_in_sent_map, kTrialsOfSentMaps, GetParam().located_in_sent_map_min);
}

INSTANTIATE_TEST_SUITE_P(Places, TwoRobotsTrials,
                         testing::Values(Kind{"office", 90, 20}, Kind{"hall", 85, 17}, Kind{"room", 90, 20},
                                         Kind{"equal_rooms", 35, 4}),
                         [](const auto& kind) { return std::string(kind.param.name); });

} // namespace
} // namespace scanloom::slam
