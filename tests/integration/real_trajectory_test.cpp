#include "lab/estimated_trajectory.hpp"
#include "lab/perturbed_source.hpp"
#include "lab/trajectory_score.hpp"
#include "robot_client/sources/carmen_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

/// Estimates the trajectories of real logs, and of the same logs with changes that must not matter.
namespace scanloom::lab {
namespace {

/// A log and the scores that its estimate must reach: metres, mean absolute error of the verified relations.
struct RealLog {
    const char* name;
    double with_odometry;
    double without;
    std::size_t late; // scans that variants leave out at the start
};

constexpr double kAllowed = 1.3; // of the score of the log without changes
constexpr double kFalseLoopWay =
    0.5; // metres: a trajectory that is farther than this from the plain one has a false loop
constexpr double kFalseLoopTurn = 15.0; // degrees; at two places of fr079, runs differ by up to 11

struct Variant {
    Poses poses = Poses::kOdometry;
    Perturbation perturbation;
};

std::vector<Variant> variants_of(const RealLog& log) {
    std::vector<Variant> variants;
    for (const double scale : {0.97, 0.98, 0.99, 1.01, 1.02, 1.03}) {
        for (const std::size_t skip : {std::size_t{0}, log.late, 3 * log.late}) {
            variants.push_back({Poses::kOdometry, {.odometry_scale = scale, .skip = skip}});
        }
        variants.push_back({Poses::kOdometry, {.odometry_scale = scale, .every = 2}});
    }
    for (const std::size_t skip : {1U, 2U, 3U, 4U, 5U, 6U})
        variants.push_back({Poses::kNone, {.skip = skip * log.late / 2}});
    return variants;
}

/// Returns the largest distances of a trajectory from another one's scans, in metres and degrees, after the rigid
/// motion that lays it on them with the least squares.
std::pair<double, double> distance_between(const std::vector<Pose2>& reference, const std::vector<Pose2>& poses) {
    const auto count = static_cast<double>(poses.size());
    Point2 center{0.0, 0.0};
    Point2 reference_center{0.0, 0.0};
    for (std::size_t n = 0; n < poses.size(); ++n) {
        center += Point2{poses[n].x, poses[n].y} / count;
        reference_center += Point2{reference[n].x, reference[n].y} / count;
    }
    double cross = 0.0;
    double dot = 0.0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
        const Point2 a = Point2{poses[n].x, poses[n].y} - center;
        const Point2 b = Point2{reference[n].x, reference[n].y} - reference_center;
        cross += a.x * b.y - a.y * b.x;
        dot += a.x * b.x + a.y * b.y;
    }
    const Pose2 turn{0.0, 0.0, std::atan2(cross, dot)};
    double way = 0.0;
    double angle = 0.0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
        const Point2 moved = transform(turn, Point2{poses[n].x, poses[n].y} - center) + reference_center;
        way = std::max(way, std::hypot(moved.x - reference[n].x, moved.y - reference[n].y));
        angle = std::max(angle, std::fabs(normalize_angle(poses[n].yaw + turn.yaw - reference[n].yaw)));
    }
    return {way, angle * 180.0 / std::numbers::pi};
}

class RealTrajectory : public testing::TestWithParam<RealLog> {
protected:
    void SetUp() override {
        if (std::filesystem::exists(path(".clf.bz2"))) return;
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << path(".clf.bz2");
    }

    [[nodiscard]] static std::filesystem::path path(const std::string& ending) {
        return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs" / (GetParam().name + ending);
    }

    [[nodiscard]] static std::vector<robot::StampedPose> estimate(const Variant& variant) {
        auto log = robot::CarmenLog::open(path(".clf.bz2"), {.poses = variant.poses}, [](const robot::SkippedLine&) {});
        EXPECT_TRUE(log) << log.error().message;
        PerturbedSource source(*log, variant.perturbation);
        auto trajectory = estimate_trajectory(
            source, [] { return 0.0; }, [](std::size_t) {});
        EXPECT_TRUE(trajectory) << trajectory.error().message;
        return trajectory->final_poses;
    }

    [[nodiscard]] static double score(const std::vector<robot::StampedPose>& trajectory, RelationUse use) {
        const auto relations = read_relations(path(".relations"));
        EXPECT_TRUE(relations) << relations.error().message;
        const auto found = score_trajectory(trajectory, *relations, use);
        EXPECT_TRUE(found) << found.error().message;
        return found->translation.absolute.mean;
    }
};

TEST_P(RealTrajectory, EstimatesAreExactWithAndWithoutOdometry) {
    EXPECT_LE(score(estimate({Poses::kOdometry}), RelationUse::kInterpolated), GetParam().with_odometry);
    EXPECT_LE(score(estimate({Poses::kNone}), RelationUse::kInterpolated), GetParam().without);
}

TEST_P(RealTrajectory, PerturbedLogsGiveTheSameTrajectory) {
    const auto plain = estimate({Poses::kOdometry});
    const double limit = kAllowed * score(plain, RelationUse::kInterpolated);
    for (const Variant& variant : variants_of(GetParam())) {
        const auto& changes = variant.perturbation;
        SCOPED_TRACE(testing::Message() << "scale " << changes.odometry_scale << ", skip " << changes.skip << ", every "
                                        << changes.every << (variant.poses == Poses::kNone ? ", no odometry" : ""));
        const auto trajectory = estimate(variant);
        EXPECT_LE(score(trajectory, changes.drops_scans() ? RelationUse::kOfScans : RelationUse::kInterpolated), limit);
        std::vector<Pose2> reference;
        std::vector<Pose2> poses;
        for (std::size_t n = 0; n < trajectory.size(); ++n) {
            reference.push_back(plain[changes.skip + n * changes.every].robot);
            poses.push_back(trajectory[n].robot);
        }
        const auto [way, turn] = distance_between(reference, poses);
        EXPECT_LE(way, kFalseLoopWay);
        EXPECT_LE(turn, kFalseLoopTurn);
    }
}

INSTANTIATE_TEST_SUITE_P(Logs, RealTrajectory,
                         testing::Values(RealLog{"intel", 0.0160, 0.0165, 700}, RealLog{"fr079", 0.0330, 0.0330, 300}),
                         [](const auto& log) { return std::string(log.param.name); });

} // namespace
} // namespace scanloom::lab
