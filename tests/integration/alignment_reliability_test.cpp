#include "core/landmarks/localization.hpp"
#include "tests/support/located_robot.hpp"
#include "tests/support/standing_robot.hpp"
#include "tests/unit/core/landmarks/pose_errors.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <string>

/// How often locate() is right, on a hundred random scenes of each kind: the table of docs/landmarks.md.
namespace scanloom::landmarks {
namespace {

using namespace testing_support;

constexpr std::uint64_t kFirstScene = 100; // seed
constexpr std::uint64_t kScenes = 100;
constexpr double kRightMetres = 0.02;
constexpr double kRightDegrees = 0.5;
constexpr std::size_t kMayDiffer = 2; // scenes whose result may differ with another compiler or processor

sim::World world_of(const std::string& name) {
    auto world = sim::find_world(name).value();
    if (name == "office") world.starts = {{-15.0, -10.0, 15.0, 10.0}}; // also in rooms, not only in the corridor
    return world;
}

/// A row of the table.
struct Kind {
    const char* seen; ///< the world of the view
    const char* map;
    int captures;      ///< in the map
    std::size_t right; ///< by docs/landmarks.md
};

void PrintTo(const Kind& kind, std::ostream* out) {
    *out << fmt::format("{}_in_{}_of_{}", kind.seen, kind.map, kind.captures);
}

class AlignmentReliability : public testing::TestWithParam<Kind> {
protected:
    /// Locates the view of a scene.
    /// @return the result, and the true pose if the view is of the map's world
    static std::pair<Alignment, std::optional<Pose2>> try_scene(std::uint64_t seed) {
        const auto [seen, map, captures, right] = GetParam();
        const auto world = world_of(map);
        const auto scene = mapped_world(world, captures, seed);
        const auto references = as_references(scene.map);
        if (world.name == seen) return {locate(references, {.points = scene.seen}).value(), scene.ground_truth};
        const auto other = world_of(seen);
        sim::Random random(seed);
        const auto view = standing_capture(other, free_place(other, random), sim::kMappedTurns, random);
        return {locate(references, {.points = view}).value(), std::nullopt};
    }
};

TEST_P(AlignmentReliability, ClearResultsAreRight) {
    std::size_t right = 0;
    std::array<std::size_t, 3> with{}; // scenes of each certainty
    double worst_metres = 0.0;
    double worst_degrees = 0.0;
    for (std::uint64_t seed = kFirstScene; seed < kFirstScene + kScenes; ++seed) {
        const auto [found, ground_truth] = try_scene(seed);
        ++with.at(static_cast<std::size_t>(found.certainty));
        if (found.certainty != Certainty::kClear) continue;
        ASSERT_TRUE(ground_truth) << "scene " << seed << ": clear, but the view is of another world";
        const double metres = metres_off(found.T_first_second, *ground_truth);
        const double degrees = degrees_off(found.T_first_second, *ground_truth);
        const bool is_right = metres <= kRightMetres && degrees <= kRightDegrees;
        EXPECT_TRUE(is_right) << fmt::format("scene {}: off by {:.1f} mm and {:.2f} degrees", seed, 1e3 * metres,
                                             degrees);
        right += is_right ? 1 : 0;
        worst_metres = std::max(worst_metres, metres);
        worst_degrees = std::max(worst_degrees, degrees);
    }
    EXPECT_GE(right + kMayDiffer, GetParam().right);
    fmt::print("right {}, ambiguous {}, undetermined {}, off by at most {:.1f} mm and {:.2f} degrees\n", right,
               with.at(static_cast<std::size_t>(Certainty::kAmbiguous)),
               with.at(static_cast<std::size_t>(Certainty::kUndetermined)), 1e3 * worst_metres, worst_degrees);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AlignmentReliability,
                         testing::Values(Kind{"room", "room", 1, 99}, Kind{"office", "office", 1, 88},
                                         Kind{"hall", "hall", 1, 66}, Kind{"room", "room", 4, 100},
                                         Kind{"office", "office", 4, 91}, Kind{"hall", "hall", 4, 84},
                                         Kind{"room", "room", 12, 100}, Kind{"office", "office", 12, 92},
                                         Kind{"hall", "hall", 12, 87}, Kind{"room", "office", 1, 0},
                                         Kind{"room", "office", 4, 0}, Kind{"room", "office", 12, 0}),
                         [](const auto& test) { return testing::PrintToString(test.param); });

} // namespace
} // namespace scanloom::landmarks
