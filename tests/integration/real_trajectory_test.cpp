#include "core/slam/trajectory_estimator.hpp"
#include "lab/localization_experiment.hpp"
#include "lab/recorded_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

/// Estimates the trajectories of real logs, and of the same logs with changes that must not matter.
namespace scanloom::lab {
namespace {

/// A log and the scores that its estimate must reach: metres, mean absolute error of the verified relations.
struct RealLog {
    const char* name;
    double with_odometry;
    double without;
};

constexpr double kAllowed = 1.3; // of the error of the log without changes, for the same relations

class RealTrajectory : public testing::TestWithParam<RealLog> {
protected:
    void SetUp() override {
        if (std::filesystem::exists(path(".clf.bz2"))) return;
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << path(".clf.bz2");
    }

    [[nodiscard]] static std::filesystem::path path(const std::string& ending) {
        return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs" / (GetParam().name + ending);
    }

    [[nodiscard]] static double error_of(const TrajectoryScore& score) { return score.translation.absolute.mean; }
};

TEST_P(RealTrajectory, EstimatesAreExactAndPerturbedLogsGiveTheSameTrajectory) {
    const auto log = read_recorded_log({path(".clf.bz2").string(), path(".relations").string()});
    ASSERT_TRUE(log) << log.error().message;
    const auto result =
        run_localization(*log, {[] { return 0.0; }, [](const std::string&, const tiles::Bytes&) { return Result<>(); },
                                [](std::string_view) {}});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_LE(error_of(result->with_odometry.final_poses), GetParam().with_odometry);
    EXPECT_LE(error_of(result->without.final_poses), GetParam().without);
    EXPECT_EQ(result->variants.size(), 30U);
    for (const auto& [variant, score, ratio, distance] : result->variants) {
        SCOPED_TRACE(text_of(variant));
        ASSERT_TRUE(score);
        EXPECT_LE(ratio, kAllowed);
        EXPECT_LE(distance.metres, kFalseLoopMetres);
        EXPECT_LE(distance.degrees, kFalseLoopDegrees);
    }
}

/// The rest of a log is a second robot, with an odometry frame of its own.
TEST_P(RealTrajectory, ARobotThatStartsAnywhereFindsItsPlaceInWhatAnotherOneHasSeen) {
    const auto log = read_recorded_log({path(".clf.bz2").string(), path(".relations").string()});
    ASSERT_TRUE(log) << log.error().message;
    const auto& scans = log->scans;
    slam::SharedMap whole_map;
    slam::TrajectoryEstimator whole(whole_map, 0);
    for (const auto& [sensor, scan] : scans) whole.add(scan, *sensor);
    whole.finish();
    for (const double part : {0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
        SCOPED_TRACE(part);
        slam::SharedMap map;
        slam::TrajectoryEstimator first(map, 0);
        slam::TrajectoryEstimator second(map, 1);
        const auto start = static_cast<std::size_t>(part * static_cast<double>(scans.size()));
        for (std::size_t n = 0; n < start; ++n) first.add(scans[n].scan, *scans[n].sensor);
        const Pose2 origin = inverse(scans[start].scan.odometry.value());
        std::size_t next = start;
        while (next < scans.size() && second.located_fragments() == 0) {
            Scan scan = scans[next].scan;
            scan.odometry = compose(origin, *scan.odometry);
            second.add(scan, *scans[next++].sensor);
        }
        ASSERT_EQ(second.located_fragments(), 1U);
        EXPECT_LE(next - start, scans.size() / 5);
        const Pose2 off = compose(inverse(whole.pose_of(next - 1)), second.pose_of(next - 1 - start));
        EXPECT_LT(std::hypot(off.x, off.y), 0.2);
        EXPECT_LT(std::fabs(off.yaw), 0.05);
    }
}

INSTANTIATE_TEST_SUITE_P(Logs, RealTrajectory,
                         testing::Values(RealLog{"intel", 0.0160, 0.0165}, RealLog{"fr079", 0.0330, 0.0330}),
                         [](const auto& log) { return std::string(log.param.name); });

} // namespace
} // namespace scanloom::lab
