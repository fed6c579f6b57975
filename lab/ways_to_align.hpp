#pragma once

#include "lab/landmark_comparison.hpp"
#include "lab/pose_error.hpp"

#include "server/landmarks/alignment.hpp"

#include <optional>
#include <string>

/// What landmarks alone tell of how two captures lie on each other, beside what their surfaces do.
namespace scanloom::lab {

/// Metres within which matched landmarks agree on a transform: as near as those are that count as stable.
inline constexpr double kAgreeingDistance = landmarks::kTolerance / 2.0;

/// The transform of matched landmarks.
struct LandmarkFit {
    std::size_t agreeing = 0; ///< pairs
    double rms = 0.0;         ///< metres, of these
    PoseError error;          ///< of where it puts the second lidar
};

struct ByLandmarks {
    std::size_t pairs = 0;
    std::optional<LandmarkFit> fit;
    std::string refusal; ///< why there is none; empty where there is one
};

struct BySurfaces {
    landmarks::Alignment alignment;
    PoseError error;
};

struct WaysToAlign {
    ByLandmarks by_landmarks;
    BySurfaces by_surfaces;
};

/// Two captures, and where their lidars stood.
struct PlacedCaptures {
    const SeenLandmarks& first; ///< in the map frame
    const SeenLandmarks& second;
    Pose2 T_map_first;
    Pose2 T_map_second;
};

/// Both ways from the first lidar to the second. The landmarks' pairs were matched by the true poses; the surfaces are
/// told nothing of these.
/// Errors  those of align(). What speaks against a transform of landmarks is a refusal, and no error.
[[nodiscard]] Result<WaysToAlign> align_both_ways(const PlacedCaptures& captures,
                                                  std::span<const landmarks::Match> matches);

} // namespace scanloom::lab
