#include "lab/localization_experiment.hpp"

#include "lab/estimated_trajectory.hpp"

#include "tests/unit/lab/driven_log.hpp"

#include <opencv2/imgcodecs.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <numbers>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

/// The result of the simulated log, computed once, and what was given to the hooks.
class LocalizationExperiment : public testing::Test {
protected:
    struct Run {
        DrivenLog driven = driven_log();
        std::map<std::string, tiles::Bytes> pictures;
        std::vector<std::string> steps;
        double clock = 0.0;
        LogResult result;
    };

    static void SetUpTestSuite() {
        run_ = std::make_unique<Run>();
        const auto result =
            run_localization(run_->driven.log, {[] { return run_->clock += 0.25; },
                                                [](const std::string& file, const tiles::Bytes& png) {
                                                    run_->pictures[file] = png;
                                                    return Result<>();
                                                },
                                                [](std::string_view step) { run_->steps.emplace_back(step); }});
        ASSERT_TRUE(result) << result.error().message;
        run_->result = *result;
    }
    static void TearDownTestSuite() { run_.reset(); }

    static const LogResult& result() { return run_->result; }
    static const DrivenLog& driven() { return run_->driven; }

    static std::unique_ptr<Run> run_;
};

std::unique_ptr<LocalizationExperiment::Run> LocalizationExperiment::run_;

TEST_F(LocalizationExperiment, ScoresTheOdometryAsTheTrueRelativePosesDo) {
    double metres = 0.0;
    double degrees = 0.0;
    double path = 0.0;
    const auto& scans = driven().log.scans;
    const auto& true_poses = driven().true_poses;
    const auto complex_of = [](const Pose2& pose) { return std::complex(pose.x, pose.y); };
    for (std::size_t n = kBetweenRelated; n < true_poses.size(); ++n) {
        const Pose2& from = *scans[n - kBetweenRelated].scan.odometry;
        const Pose2& to = *scans[n].scan.odometry;
        const Pose2& true_from = true_poses[n - kBetweenRelated];
        const Pose2& true_to = true_poses[n];
        // The way by odometry and the true way, both in the frame of their start; a wrong turn moves the true start.
        const auto way = (complex_of(to) - complex_of(from)) * std::polar(1.0, -from.yaw);
        const auto true_way = (complex_of(true_to) - complex_of(true_from)) * std::polar(1.0, -true_from.yaw);
        const double wrong_turn = (to.yaw - from.yaw) - (true_to.yaw - true_from.yaw);
        metres += std::abs(way - true_way * std::polar(1.0, wrong_turn));
        degrees += std::fabs(std::remainder(wrong_turn, 2.0 * std::numbers::pi)) * 180.0 / std::numbers::pi;
    }
    for (std::size_t n = 1; n < true_poses.size(); ++n)
        path += 1.05 * std::hypot(true_poses[n].x - true_poses[n - 1].x, true_poses[n].y - true_poses[n - 1].y);
    const auto count = static_cast<double>(driven().log.relations.size());
    EXPECT_EQ(result().odometry.used, driven().log.relations.size());
    EXPECT_NEAR(result().odometry.translation.absolute.mean, metres / count, 1e-9);
    EXPECT_NEAR(result().odometry.rotation.absolute.mean, degrees / count, 1e-9);
    EXPECT_NEAR(result().path, path, 1e-6);
    EXPECT_NEAR(result().seconds, 0.5 * static_cast<double>(true_poses.size() - 1), 1e-9);
    EXPECT_EQ(result().scans, true_poses.size());
}

TEST_F(LocalizationExperiment, EstimatesAreBetterThanTheOdometry) {
    const double odometry = result().odometry.translation.absolute.mean;
    EXPECT_GT(odometry, 0.05);
    for (const auto& estimate : {result().with_odometry, result().without}) {
        EXPECT_LT(estimate.final_poses.translation.absolute.mean, 0.02);
        EXPECT_LT(estimate.first_poses.translation.absolute.mean, 0.02);
        EXPECT_EQ(estimate.unplaced, 0U);
        EXPECT_EQ(estimate.final_poses.used, driven().log.relations.size());
    }
    EXPECT_LT(result().without_from_plain.metres, 0.1);
    EXPECT_GT(result().without_from_plain.metres, 0.0);
}

TEST_F(LocalizationExperiment, ScoresAreThoseOfFinalAndFirstPoses) {
    const std::pair<Poses, EstimateResult> estimates[] = {{Poses::kOdometry, result().with_odometry},
                                                          {Poses::kNone, result().without}};
    for (const auto& [poses, estimate] : estimates) {
        LogReplay replay(driven().log, poses);
        const auto trajectory = estimate_trajectory(
            replay, [] { return 0.0; }, [](std::size_t) {});
        const auto error_of = [&](const std::vector<robot::StampedPose>& scored) {
            return score_trajectory(scored, driven().log.relations, RelationUse::kInterpolated)
                ->translation.absolute.mean;
        };
        EXPECT_EQ(estimate.final_poses.translation.absolute.mean, error_of(trajectory->final_poses));
        EXPECT_EQ(estimate.first_poses.translation.absolute.mean, error_of(trajectory->first_poses));
        EXPECT_NE(error_of(trajectory->final_poses), error_of(trajectory->first_poses));
    }
}

TEST_F(LocalizationExperiment, CpuTimeIsThatOfEachScanAndOfTheEnd) {
    const double readings = static_cast<double>(driven().true_poses.size() + 1);
    EXPECT_DOUBLE_EQ(result().with_odometry.cpu_seconds, 0.25 * readings);
    EXPECT_DOUBLE_EQ(result().without.cpu_seconds, 0.25 * readings);
}

/// Returns the mean translation error of the plain estimate for the relations of the scans that a perturbation leaves.
double plain_error(const RecordedLog& log, const Perturbation& perturbation) {
    LogReplay replay(log, Poses::kOdometry);
    const auto plain = estimate_trajectory(
        replay, [] { return 0.0; }, [](std::size_t) {});
    std::vector<Relation> relations;
    for (std::size_t n = perturbation.skip; n + kBetweenRelated < log.scans.size(); ++n) {
        if (perturbation.every == 1 || n % 2 == 0) relations.push_back(log.relations[n]);
    }
    return score_trajectory(plain->final_poses, relations, RelationUse::kInterpolated)->translation.absolute.mean;
}

TEST_F(LocalizationExperiment, EachVariantIsComparedWithThePlainEstimate) {
    const auto expected = variants_of(driven().true_poses.size());
    ASSERT_EQ(result().variants.size(), expected.size());
    for (std::size_t n = 0; n < expected.size(); ++n) {
        const auto& [variant, score, ratio, distance] = result().variants[n];
        SCOPED_TRACE(text_of(variant));
        EXPECT_EQ(text_of(variant), text_of(expected[n]));
        ASSERT_TRUE(score);
        EXPECT_LT(score->translation.absolute.mean, 0.02);
        EXPECT_NEAR(ratio, score->translation.absolute.mean / plain_error(driven().log, variant.perturbation), 1e-9);
        EXPECT_GT(distance.metres, 0.0);
        EXPECT_FALSE(is_false_loop(distance));
        // Relations connect scans that are 20 apart, so both are even or both are odd.
        const auto& changes = variant.perturbation;
        const auto first_scans = driven().true_poses.size() - changes.skip - kBetweenRelated;
        EXPECT_EQ(score->used, changes.every == 2 ? (first_scans + 1) / 2 : first_scans);
    }
}

TEST_F(LocalizationExperiment, DrawsThreeMapsOfTheRoom) {
    ASSERT_EQ(run_->pictures.size(), 3U);
    for (const auto& [file, cell_size, width, height] : result().maps) {
        const cv::Mat picture = cv::imdecode(run_->pictures.at(file), cv::IMREAD_GRAYSCALE);
        EXPECT_EQ(cell_size, 0.05);
        EXPECT_NEAR(picture.cols * 0.05, width, 1e-9);
        EXPECT_NEAR(picture.rows * 0.05, height, 1e-9);
    }
    EXPECT_EQ(result().maps[0].file, "room_raw_odometry.png");
    EXPECT_EQ(result().maps[1].file, "room_with_odometry.png");
    EXPECT_EQ(result().maps[2].file, "room_without_odometry.png");
    for (const int estimated : {1, 2}) {
        EXPECT_NEAR(result().maps[estimated].width, 8.0, 0.4)
            << "the robot begins along the room's longer side, at 90 degrees";
        EXPECT_NEAR(result().maps[estimated].height, 10.0, 0.4);
    }
    EXPECT_GT(result().maps[0].height, 10.6);
}

TEST_F(LocalizationExperiment, StepsNameTheLog) {
    EXPECT_THAT(run_->steps, testing::Each(testing::StartsWith("room: ")));
    EXPECT_EQ(run_->steps.back(), "room: variant 30 of 30");
}

const LocalizationHooks kNoHooks{[] { return 0.0; }, [](const std::string&, const tiles::Bytes&) { return Result<>(); },
                                 [](std::string_view) {}};

TEST(LocalizationErrors, RelationsOfAnotherLogAreAnErrorBeforeTheEstimates) {
    auto driven = driven_log();
    for (auto& relation : driven.log.relations) relation.from_stamp += 10'000.0;
    const auto score = score_odometry(driven.log);
    ASSERT_FALSE(score);
    EXPECT_THAT(score.error().message, HasSubstr("room: no relation of"));
    std::size_t steps = 0;
    auto hooks = kNoHooks;
    hooks.tell = [&](std::string_view) { ++steps; };
    EXPECT_EQ(run_localization(driven.log, hooks).error().code, score.error().code);
    EXPECT_EQ(steps, 0U);
}

TEST(LocalizationErrors, PicturesThatCannotBeKeptEndTheRun) {
    auto driven = driven_log();
    driven.log.scans.resize(50);
    auto hooks = kNoHooks;
    hooks.keep_picture = [](const std::string& file, const tiles::Bytes&) -> Result<> {
        return Error{Errc::kStoreFailed, file + ": disk full"};
    };
    const auto result = run_localization(driven.log, hooks);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().message, "room_raw_odometry.png: disk full");
}

TEST(LocalizationErrors, VariantWithoutRelationsHasNoScore) {
    auto driven = driven_log();
    driven.log.scans.resize(60);
    driven.log.relations.resize(1); // of scans 0 and 20
    const auto result = run_localization(driven.log, kNoHooks);
    ASSERT_TRUE(result) << result.error().message;
    for (const auto& [variant, score, ratio, distance] : result->variants) {
        EXPECT_EQ(score.has_value(), variant.perturbation.skip == 0) << text_of(variant);
    }
}

TEST(LocalizationErrors, LogOfOneScanIsAnError) {
    auto driven = driven_log();
    driven.log.scans.resize(1);
    driven.log.relations = {{100.0, 100.0, {}}};
    const auto result = run_localization(driven.log, kNoHooks);
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, HasSubstr("room, odometry x 0.97, without the first 1 scans: no scan is left"));
}

} // namespace
} // namespace scanloom::lab
