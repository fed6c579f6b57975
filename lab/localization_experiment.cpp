#include "lab/localization_experiment.hpp"

#include "lab/estimated_trajectory.hpp"
#include "lab/trajectory_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

using Poses2 = std::vector<robot::StampedPose>;

Result<EstimatedTrajectory> estimate_variant(const RecordedLog& log, const Variant& variant,
                                             const std::function<double()>& cpu_seconds) {
    LogReplay replay(log, variant.poses);
    PerturbedSource source(replay, variant.perturbation);
    auto trajectory = estimate_trajectory(source, cpu_seconds, [](std::size_t) {});
    if (!trajectory) return prefixed(fmt::format("{}, {}: ", log.name, text_of(variant)), trajectory.error());
    return trajectory;
}

Result<EstimateResult> result_of(const RecordedLog& log, const EstimatedTrajectory& trajectory) {
    const auto final_poses = score_trajectory(trajectory.final_poses, log.relations, RelationUse::kInterpolated);
    if (!final_poses) return prefixed(log.name + ": ", final_poses.error());
    const auto first_poses = score_trajectory(trajectory.first_poses, log.relations, RelationUse::kInterpolated);
    if (!first_poses) return prefixed(log.name + ": ", first_poses.error());
    const auto unplaced = std::ranges::count(trajectory.is_located, false);
    return EstimateResult{*final_poses, *first_poses, static_cast<std::size_t>(unplaced), trajectory.cpu_seconds};
}

Result<DrawnMap> keep_map(const RecordedLog& log, std::string_view kind, const Poses2& poses,
                          const std::vector<bool>& is_located, const LocalizationHooks& hooks) {
    std::vector<std::optional<Pose2>> of_scans(poses.size());
    for (std::size_t n = 0; n < poses.size(); ++n) {
        if (is_located[n]) of_scans[n] = poses[n].robot;
    }
    const auto map = draw_map(log.scans, of_scans, kPictureSideMax);
    if (!map) return prefixed(fmt::format("{}, {}: ", log.name, kind), map.error());
    const auto file = fmt::format("{}_{}.png", log.name, kind);
    if (auto kept = hooks.keep_picture(file, map->png); !kept) return kept.error();
    return DrawnMap{file, map->cell_size, map->width * map->cell_size, map->height * map->cell_size};
}

/// Returns poses in another frame, in which the first one is given.
Poses2 begun_at(const Pose2& first, Poses2 poses) {
    const Pose2 T_new_old = compose(first, inverse(poses.front().robot));
    for (auto& pose : poses) pose.robot = compose(T_new_old, pose.robot);
    return poses;
}

double path_of(const Poses2& poses) {
    double path = 0.0;
    for (std::size_t n = 1; n < poses.size(); ++n) {
        path += std::hypot(poses[n].robot.x - poses[n - 1].robot.x, poses[n].robot.y - poses[n - 1].robot.y);
    }
    return path;
}

} // namespace

Result<TrajectoryScore> score_odometry(const RecordedLog& log) {
    auto score = score_trajectory(odometry_of(log), log.relations, RelationUse::kInterpolated);
    if (!score) return prefixed(log.name + ": ", score.error());
    return score;
}

Result<LogResult> run_localization(const RecordedLog& log, const LocalizationHooks& hooks) {
    const Poses2 odometry = odometry_of(log);
    LogResult result{.name = log.name, .scans = log.scans.size(), .path = path_of(odometry)};
    const auto [first, last] = std::ranges::minmax(odometry, {}, &robot::StampedPose::stamp);
    result.seconds = last.stamp - first.stamp;
    const auto odometry_score = score_odometry(log);
    if (!odometry_score) return odometry_score.error();
    result.odometry = *odometry_score;

    std::array<EstimatedTrajectory, 2> estimates;
    std::array<EstimateResult*, 2> results{&result.with_odometry, &result.without};
    for (std::size_t n = 0; n < 2; ++n) {
        const Poses poses = n == 0 ? Poses::kOdometry : Poses::kNone;
        hooks.tell(fmt::format("{}: estimate, poses: {}", log.name, name_of(poses)));
        auto estimated = estimate_variant(log, {.poses = poses}, hooks.cpu_seconds);
        if (!estimated) return estimated.error();
        const auto figures = result_of(log, *estimated);
        if (!figures) return figures.error();
        estimates[n] = std::move(*estimated);
        *results[n] = *figures;
    }
    const Poses2& plain = estimates[0].final_poses;
    result.without_from_plain = distance_between(plain, estimates[1].final_poses);

    hooks.tell(fmt::format("{}: maps", log.name));
    struct Layout {
        std::string_view kind;
        const Poses2& poses;
        const std::vector<bool>& is_located;
    };
    const std::vector<bool> all(log.scans.size(), true);
    const Poses2 without = begun_at(plain.front().robot, estimates[1].final_poses); // so that both maps look alike
    const Layout layouts[] = {{"raw_odometry", odometry, all},
                              {"with_odometry", plain, estimates[0].is_located},
                              {"without_odometry", without, estimates[1].is_located}};
    for (std::size_t n = 0; n < result.maps.size(); ++n) {
        auto map = keep_map(log, layouts[n].kind, layouts[n].poses, layouts[n].is_located, hooks);
        if (!map) return map.error();
        result.maps[n] = std::move(*map);
    }

    hooks.tell(fmt::format("{}: unknown starts", log.name));
    result.unknown_starts = start_anywhere(log, plain);

    const auto variants = variants_of(log.scans.size());
    for (const Variant& variant : variants) {
        hooks.tell(fmt::format("{}: variant {} of {}", log.name, result.variants.size() + 1, variants.size()));
        const auto estimated = estimate_variant(log, variant, hooks.cpu_seconds);
        if (!estimated) return estimated.error();
        const auto of_plain = part_of(plain, variant.perturbation);
        VariantResult of_variant{.variant = variant, .from_plain = distance_between(of_plain, estimated->final_poses)};
        const auto use = variant.perturbation.drops_scans() ? RelationUse::kOfScans : RelationUse::kInterpolated;
        const auto score = score_trajectory(estimated->final_poses, log.relations, use);
        const auto plain_score = score_trajectory(of_plain, log.relations, use);
        if (score && plain_score) {
            of_variant.score = *score;
            of_variant.ratio = score->translation.absolute.mean / plain_score->translation.absolute.mean;
        }
        result.variants.push_back(std::move(of_variant));
    }
    return result;
}

} // namespace scanloom::lab
