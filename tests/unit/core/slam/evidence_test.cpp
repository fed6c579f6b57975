#include "core/slam/evidence.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::Building;

/// A hall with a box in it.
Building hall(double box_at) {
    Building building;
    building.add_box(0.0, 0.0, 12.0, 8.0);
    building.add_box(box_at, 3.0, box_at + 1.0, 4.0);
    return building;
}

/// Returns the points of a scan in a hall.
std::shared_ptr<const ScanPoints> scan_in(const Building& building, const Pose2& pose, std::mt19937& random) {
    return std::make_shared<const ScanPoints>(
        scan_matching::points_of(building.scan(Building::laser(), pose, 0.01, random), Building::laser()));
}

/// Makes keyframes along the hall, and returns contradictions_between() them.
/// @param first_box   where the first, third, ... keyframe sees the box, metres
/// @param second_box  where the second, fourth, ... keyframe sees it
double contradictions(double first_box, double second_box, std::size_t count = 12) {
    std::mt19937 random(1);
    KeyframeGraph graph;
    Transform2 before;
    std::vector<std::size_t> keyframes(count);
    std::iota(keyframes.begin(), keyframes.end(), std::size_t{0});
    for (const std::size_t n : keyframes) {
        const Pose2 pose{1.0 + 0.4 * static_cast<double>(n), 1.0, 0.7};
        const Transform2 at = transform_of(pose);
        add(graph, scan_in(hall(n % 2 == 0 ? first_box : second_box), pose, random),
            n == 0 ? at : inverse(before) * at);
        before = at;
    }
    return contradictions_between(graph, keyframes);
}

TEST(Evidence, KeyframesOfAHallThatStaysDoNotContradictEachOther) { EXPECT_LT(contradictions(8.0, 8.0), 0.01); }

TEST(Evidence, ABoxThatMovesContradicts) {
    EXPECT_GT(contradictions(8.0, 6.5), 0.05);
    EXPECT_LT(contradictions(8.0, 6.5), 0.5) << "the walls agree";
}

TEST(Evidence, OneKeyframeDoesNotContradictItself) { EXPECT_EQ(contradictions(8.0, 8.0, 1), 0.0); }

TEST(Evidence, CountsSurfacesThatAgreeAndThoseInSeenSpaceOrBehindWalls) {
    std::mt19937 random(2);
    const Pose2 pose{2.0, 3.5, 0.0};
    KeyframeGraph graph;
    add(graph, scan_in(hall(8.0), pose, random), transform_of(pose));
    KeyframeViews views;
    views.add(graph[0], graph.pose(0));
    KeyframeMap map(std::move(views));
    const auto evidence_at = [&](float x) {
        Evidence evidence;
        evidence.add(map, transform_of(pose), {}, {.x = x, .y = 0.0F, .normal_x = -1.0F, .normal_y = 0.0F});
        return evidence;
    };
    EXPECT_EQ(evidence_at(6.0F).matched, Evidence::kSquare) << "the front of the box";
    EXPECT_EQ(evidence_at(4.0F).contradicted, Evidence::kSquare) << "in space that was seen free";
    EXPECT_EQ(evidence_at(8.0F).contradicted, Evidence::kSquare) << "behind the front of the box";
    Evidence beside;
    beside.add(map, transform_of({11.5, 3.5, 0.0}), {}, {.x = -1.5F, .y = 0.0F, .normal_x = -1.0F, .normal_y = 0.0F});
    EXPECT_EQ(beside.matched + beside.contradicted, 0.0) << "in the shadow of the box";
    EXPECT_EQ(beside.share(), 0.0);
}

} // namespace
} // namespace scanloom::slam
