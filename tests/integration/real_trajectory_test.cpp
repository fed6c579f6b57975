#include "lab/localization_experiment.hpp"
#include "lab/recorded_log.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

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

TEST_P(RealTrajectory, EstimatesAreExactAlsoOfPerturbedLogsAndUnknownStarts) {
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
    EXPECT_EQ(result->unknown_starts.size(), 12U);
    for (const auto& [poses, part, found] : result->unknown_starts) {
        SCOPED_TRACE(fmt::format("{}, {}", name_of(poses), part));
        ASSERT_TRUE(found);
        EXPECT_LE(found->scans, log->scans.size() * 3 / 10);
        EXPECT_LT(found->metres, 0.2);
        EXPECT_LT(found->degrees, 3.0);
    }
}

INSTANTIATE_TEST_SUITE_P(Logs, RealTrajectory,
                         testing::Values(RealLog{"intel", 0.0160, 0.0165}, RealLog{"fr079", 0.0330, 0.0330}),
                         [](const auto& log) { return std::string(log.param.name); });

} // namespace
} // namespace scanloom::lab
