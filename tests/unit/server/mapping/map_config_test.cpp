#include "server/mapping/map_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::mapping {
namespace {

void expect_refused(const SessionOptions& options, const std::string& field) {
    const auto config = resolve(options);
    ASSERT_FALSE(config) << field;
    EXPECT_EQ(config.error().code, Errc::kInvalidField);
    EXPECT_THAT(config.error().message, testing::StartsWith(field + " is "));
}

TEST(MapConfig, AbsentOptionsTakeTheDefaults) {
    const auto config = resolve({});
    ASSERT_TRUE(config);
    EXPECT_EQ(*config, MapConfig{});
}

TEST(MapConfig, AbsurdCellSizesAreRefusedByName) {
    for (const double cell_size : {0.0, -0.05, 0.0099, 1.01, 1e300, HUGE_VAL, static_cast<double>(NAN)}) {
        expect_refused({.cell_size = cell_size}, "cell_size");
    }
    for (const double cell_size : {0.01, 0.05, 0.1, 0.5, 1.0}) EXPECT_TRUE(resolve({.cell_size = cell_size}));
}

TEST(MapConfig, EveryOtherFieldIsCheckedByName) {
    const double nan = NAN;
    for (const double p : {0.5, 1.0, 0.2, nan}) expect_refused({.p_occupied = p}, "p_occupied");
    for (const double p : {0.0, 0.5, 0.7, nan}) expect_refused({.p_free = p}, "p_free");
    for (const double p : {0.0, 0.2, nan}) expect_refused({.p_min = p}, "p_min");
    for (const double p : {0.8, 1.0, nan}) expect_refused({.p_max = p}, "p_max");
    for (const double p : {0.0, 1.0, 0.95, 0.05, nan}) expect_refused({.p_prior = p}, "p_prior");
    for (const double m : {0.0, -1.0, 11.0, nan}) expect_refused({.obstacle_thickness = m}, "obstacle_thickness");
    for (const double a : {0.0, -1.0, 4.0, nan}) expect_refused({.beam_aperture = a}, "beam_aperture");
}

TEST(MapConfig, OptionsAndConfigurationDescribeEachOther) {
    const auto config = resolve({.cell_size = 0.1, .p_free = 0.3, .obstacle_thickness = 0.4});
    ASSERT_TRUE(config);
    EXPECT_EQ(*resolve(options_of(*config)), *config);
}

TEST(MapConfig, AnAskingThatDiffersFromTheSessionIsAConflictThatNamesTheField) {
    const MapConfig config;
    EXPECT_TRUE(check_agreement(config, {}));
    EXPECT_TRUE(check_agreement(config, {.cell_size = 0.05}));
    const auto conflict = check_agreement(config, {.cell_size = 0.1});
    ASSERT_FALSE(conflict);
    EXPECT_EQ(conflict.error().code, Errc::kConflict);
    EXPECT_THAT(conflict.error().message, testing::HasSubstr("cell_size 0.05, cell_size 0.1"));
}

} // namespace
} // namespace scanloom::mapping
