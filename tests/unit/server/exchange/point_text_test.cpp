#include "server/exchange/point_text.hpp"

#include <gtest/gtest.h>

#include <array>

namespace scanloom::exchange {
namespace {

const std::array<landmarks::CloudPoint, 2> kPoints{
    landmarks::CloudPoint{-1.5707963, 2.00002, {1.01, -2.0}, 3, 1, 11},
    landmarks::CloudPoint{3.1415927, 5.0, {-5.0, 0.00005}, 1, 0, 12},
};

TEST(PointText, CsvHasOneLinePerPoint) {
    EXPECT_EQ(points_csv(kPoints, std::array<std::string, 2>{"left", "right"}),
              "angle,distance,x,y,seen,robot,revision\n"
              "-1.57080,2.0000,1.0100,-2.0000,3,right,11\n"
              "3.14159,5.0000,-5.0000,0.0001,1,left,12\n");
    EXPECT_EQ(points_csv({}, {}), "angle,distance,x,y,seen,robot,revision\n");
}

TEST(PointText, PlyHasOneVertexPerPoint) {
    EXPECT_EQ(points_ply(kPoints), "ply\nformat ascii 1.0\ncomment metres, map frame\nelement vertex 2\n"
                                   "property double x\nproperty double y\nproperty double z\nproperty uint seen\n"
                                   "end_header\n"
                                   "1.0100 -2.0000 0 3\n"
                                   "-5.0000 0.0001 0 1\n");
}

TEST(PointText, PcdHasOneLinePerPoint) {
    EXPECT_EQ(points_pcd(kPoints), "# .PCD v0.7 - metres, map frame\nVERSION 0.7\nFIELDS x y z seen\nSIZE 4 4 4 4\n"
                                   "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
                                   "DATA ascii\n"
                                   "1.0100 -2.0000 0 3\n"
                                   "-5.0000 0.0001 0 1\n");
}

} // namespace
} // namespace scanloom::exchange
