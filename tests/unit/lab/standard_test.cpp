#include "lab/experiment.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

TEST(Standard, IsTheRoomWithCellsVisibleFromThePath) {
    const std::vector<Pose2> path{{-3.5, -3.8, 0.0}};
    const auto standard = make_standard(path, 0.1);
    const auto count = [&](sim::GroundTruth truth, bool is_seen) {
        std::size_t cells = 0;
        for_each_cell(standard.truth.box, [&](grid::Cell cell) {
            cells += standard.truth.at(cell) == truth && (standard.seen.at(cell) != 0) == is_seen;
        });
        return cells;
    };
    EXPECT_GT(count(sim::GroundTruth::kFree, true), 500U);
    EXPECT_GT(count(sim::GroundTruth::kFree, false), 5000U);
    EXPECT_GT(count(sim::GroundTruth::kOccupied, true), 40U);
    EXPECT_EQ(count(sim::GroundTruth::kOutside, true), 0U);
    EXPECT_EQ(standard.truth.at({-69, 0}), sim::GroundTruth::kOutside) << "2 m outside the wall";
}

TEST(WalkedCells, AreOnTheWalkersTrackExceptAtItsEnd) {
    Recording recording;
    recording.walkers = {{{{1.05, 1.05}, 0.25}}, {{{2.05, 1.05}, 0.25}}, {{{3.05, 1.05}, 0.25}}};
    const mapping::MapConfig config{.cell_size = 0.1, .obstacle_thickness = 0.2};
    const auto walked = walked_cells(recording, config, {0, 0, 40, 20});
    EXPECT_TRUE(walked.at({10, 10}));
    EXPECT_TRUE(walked.at({20, 10}));
    EXPECT_TRUE(walked.at({10, 14})) << "0.25 m body, 0.1 m marked band and 0.1 m tolerance";
    EXPECT_FALSE(walked.at({10, 15}));
    EXPECT_FALSE(walked.at({30, 10}));
    EXPECT_FALSE(walked.at({0, 0}));
}

} // namespace
} // namespace scanloom::lab
