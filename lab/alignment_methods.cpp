#include "lab/alignment_methods.hpp"

#include "core/landmarks/alignment.hpp"
#include "core/landmarks/points.hpp"

namespace scanloom::lab {
namespace {

std::vector<Point2> in_frame_of(const Pose2& T_map_lidar, std::span<const Point2> points) {
    const Pose2 T_lidar_map = inverse(T_map_lidar);
    // the surveyed points have passed these checks
    return landmarks::transform_points(points, {T_lidar_map.x, T_lidar_map.y}, T_lidar_map.yaw).value();
}

ByLandmarks align_by_landmarks(const PlacedCaptures& captures, std::span<const landmarks::Match> matches) {
    std::vector<landmarks::PointPair> pairs;
    for (const auto& match : matches) {
        pairs.push_back({.first = captures.first.survey.landmarks[match.first].position,
                         .second = captures.second.survey.landmarks[match.second].position});
    }
    ByLandmarks aligned{.pairs = pairs.size(), .fit = {}, .refusal = {}};
    const auto fit = landmarks::align_pairs_robustly(pairs, kAgreeingDistance);
    if (!fit) {
        aligned.refusal = fit.error().message;
        return aligned;
    }
    // Both captures are in the map frame, so without an error the transform is the identity.
    const Pose2 found = compose(fit->T_first_second, captures.T_map_second);
    aligned.fit = {fit->used.size(), fit->rms, pose_error(found, captures.T_map_second)};
    return aligned;
}

Result<BySurfaces> align_by_surfaces(const PlacedCaptures& captures) {
    const auto first = in_frame_of(captures.T_map_first, captures.first.points);
    const auto second = in_frame_of(captures.T_map_second, captures.second.points);
    auto alignment = landmarks::align({.points = first}, {.points = second});
    if (!alignment) return alignment.error();
    const Pose2 truth = compose(inverse(captures.T_map_first), captures.T_map_second);
    const PoseError error = pose_error(alignment->T_first_second, truth);
    return BySurfaces{std::move(*alignment), error};
}

} // namespace

Result<AlignmentMethods> align_by_both_methods(const PlacedCaptures& captures,
                                               std::span<const landmarks::Match> matches) {
    auto by_surfaces = align_by_surfaces(captures);
    if (!by_surfaces) return by_surfaces.error();
    return AlignmentMethods{align_by_landmarks(captures, matches), std::move(*by_surfaces)};
}

} // namespace scanloom::lab
