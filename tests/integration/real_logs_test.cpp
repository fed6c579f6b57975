#include "tests/support/kernel_against_oracle.hpp"
#include "tests/support/whole_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

/// Recorded logs. They are not in the repository: where they are missing, each test is skipped, and ./scanloom lists
/// it.
namespace scanloom {
namespace {

struct Recording {
    const char* file;
    std::size_t scans;
    std::size_t beams; ///< of each scan
};

void PrintTo(const Recording& recording, std::ostream* out) { *out << recording.file; }

std::filesystem::path path_of(const char* file) {
    return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs" / file;
}

class RealLogs : public testing::TestWithParam<Recording> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(path_of(GetParam().file)))
            GTEST_SKIP() << "the recorded log " << path_of(GetParam().file) << " is not here";
    }

    robot::WholeLog read(robot::NoReturn no_return) {
        auto log =
            robot::read_whole_log(path_of(GetParam().file), {.no_return = no_return, .range_max = {}, .limits = {}},
                                  [](const robot::SkippedLine& line) { ADD_FAILURE() << line.reason; });
        EXPECT_TRUE(log) << log.error().message;
        return log ? std::move(*log) : robot::WholeLog{};
    }
};

TEST_P(RealLogs, ContainEveryScanInAlmostIncreasingTime) {
    const auto log = read(robot::NoReturn::kDrop);
    ASSERT_EQ(log.observations.size(), GetParam().scans);
    EXPECT_TRUE(log.stamps.file_order);
    EXPECT_LT(log.stamps.back_max, 0.9);
    for (std::size_t n = 1; n < log.observations.size(); ++n) {
        EXPECT_GT(log.observations[n].scan.stamp, log.observations[n - 1].scan.stamp - 0.9);
    }
    for (const auto& [sensor, scan] : log.observations) {
        EXPECT_EQ(scan.ranges.size(), GetParam().beams);
        EXPECT_EQ(sensor, log.observations[0].sensor);
    }
}

TEST_P(RealLogs, GiveTheMapsOfANaiveImplementation) {
    const auto log = read(robot::NoReturn::kDrop);
    std::size_t firm = 0;
    const std::size_t step = log.observations.size() / 25;
    for (std::size_t n = 0; n < log.observations.size(); n += step) {
        const auto& [sensor, scan] = log.observations[n];
        mapping::Case c;
        c.shape = GetParam().file + (": scan " + std::to_string(n));
        c.angles = angles_of(scan, *sensor);
        c.range_min = sensor->range_min;
        c.range_max = sensor->range_max;
        c.cell_size = n / step % 6 == 0 ? 0.05 : n % 2 == 0 ? 0.1 : 0.25;
        c.T_map_sensor = compose(*scan.pose, sensor->mount);
        c.ranges = scan.ranges;
        ASSERT_NO_FATAL_FAILURE(mapping::expect_equal_to_oracle(c, firm, mapping::Beams::kIndexed));
    }
    EXPECT_GT(firm, 100'000U);
}

/// The stamps of this log go back 631 times. Sorted by stamp, the trajectory would be 661 m long, with steps of up to
/// 0.87 m.
TEST(IntelLog, HasAPlausibleTrajectory) {
    const auto path = path_of("intel.clf.bz2");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "the recorded log " << path << " is not here";
    const auto log = robot::read_whole_log(path, {}, [](const robot::SkippedLine&) {});
    ASSERT_TRUE(log) << log.error().message;
    EXPECT_EQ(log->stamps.steps_back, 631U);
    double length = 0.0;
    double step_max = 0.0;
    for (std::size_t i = 1; i < log->observations.size(); ++i) {
        const Pose2& from = *log->observations[i - 1].scan.pose;
        const Pose2& to = *log->observations[i].scan.pose;
        const double step = std::hypot(to.x - from.x, to.y - from.y);
        length += step;
        step_max = std::max(step_max, step);
    }
    EXPECT_NEAR(length, 508.0, 5.0);
    EXPECT_LT(step_max, 0.3);
}

INSTANTIATE_TEST_SUITE_P(All, RealLogs,
                         testing::Values(Recording{"intel.clf.bz2", 13'631, 180},
                                         Recording{"intel-corrected.log.gz", 910, 180},
                                         Recording{"fr079.clf.bz2", 4'934, 360},
                                         Recording{"fr079-corrected.log.gz", 4'791, 360}));

} // namespace
} // namespace scanloom
