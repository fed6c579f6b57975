#pragma once

#include "lab/landmark_comparison.hpp"
#include "lab/pose_error.hpp"

#include "core/landmarks/alignment.hpp"

#include <optional>
#include <string>

/// Compares the alignment of two captures by their landmarks alone with that by their surfaces.
namespace scanloom::lab {

/// Metres within which matched landmarks agree on a transform: the same distance within which they count as stable.
inline constexpr double kAgreeingDistance = landmarks::kTolerance / 2.0;

/// The transform computed from matched landmarks.
struct LandmarkFit {
    std::size_t agreeing = 0; ///< number of pairs
    double rms = 0.0;         ///< metres, of the agreeing pairs
    PoseError error;          ///< of the second lidar's pose by this transform
};

struct ByLandmarks {
    std::size_t pairs = 0;
    std::optional<LandmarkFit> fit;
    std::string refusal; ///< why there is no fit; empty if there is one
};

struct BySurfaces {
    landmarks::Alignment alignment;
    PoseError error;
};

struct AlignmentMethods {
    ByLandmarks by_landmarks;
    BySurfaces by_surfaces;
};

/// Two captures and the poses of their lidars.
struct PlacedCaptures {
    const SeenLandmarks& first; ///< in the map frame
    const SeenLandmarks& second;
    Pose2 T_map_first;
    Pose2 T_map_second;
};

/// Computes the transform from the first lidar to the second by both methods. The pairs of landmarks were matched by
/// the true poses, which the alignment of surfaces does not use.
/// Errors: those of align(). A transform that landmarks do not support is a refusal, not an error.
[[nodiscard]] Result<AlignmentMethods> align_by_both_methods(const PlacedCaptures& captures,
                                                             std::span<const landmarks::Match> matches);

} // namespace scanloom::lab
