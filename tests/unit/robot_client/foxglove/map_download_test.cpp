#include "robot_client/foxglove/map_download.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

TEST(GridOfMapFiles, HasTheLowestRowFirst) {
    const std::string yaml = "image: map.pgm\nresolution: 0.1\norigin: [-3, 4, 0]\nnegate: 0\n"
                             "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    const std::string pgm("P5\n3 2\n255\n\xfe\x00\xcd\xcd\xcd\xfe", 17);
    const auto grid = grid_of(yaml, pgm);
    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_EQ(grid->resolution, 0.1);
    EXPECT_EQ(grid->T_map_grid, (Pose2{-3.0, 4.0, 0.0}));
    EXPECT_EQ(grid->width, 3U);
    EXPECT_EQ(grid->cells, std::string("\xff\xff\x00\x00\x64\xff", 6));
}

TEST(GridOfMapFiles, DamagedFilesAreErrors) {
    EXPECT_FALSE(grid_of("nonsense", "P5\n1 1\n255\n\x01"));
    EXPECT_FALSE(grid_of("image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
                         "free_thresh: 0.196\n",
                         "P5\n9 9\n255\n\x01"));
}

} // namespace
} // namespace scanloom::robot
