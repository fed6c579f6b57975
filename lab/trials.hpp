#pragma once

#include "lab/integrate_recording.hpp"
#include "lab/pose_error.hpp"

#include "server/landmarks/alignment.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// Alignments of many random scenes, and how often they are right.
namespace scanloom::lab {

/// Number of scenes of each kind.
inline constexpr std::size_t kScenes = 100;

/// Returns the seed of a scene. Scenes of different experiments have different seeds.
[[nodiscard]] constexpr std::uint64_t scene_seed(std::uint64_t experiment_seed, std::size_t scene) {
    return experiment_seed * kScenes + scene;
}

enum class Verdict {
    kRight, ///< clear, and within kRightDistance and kRightDegrees of the truth
    kWrong, ///< clear, but not within these limits
    kAmbiguous,
    kUndetermined,
};
inline constexpr double kRightDistance = 0.02; ///< metres
inline constexpr double kRightDegrees = 0.5;

/// The result for one scene.
struct Trial {
    std::uint64_t seed = 0; ///< of the scene
    Verdict verdict = Verdict::kUndetermined;
    Pose2 found;
    PoseError error;
    double explained = 0.0;                   ///< see landmarks::Alignment
    std::optional<double> explained_at_truth; ///< of a wrong one beyond kElsewhere: searched near the truth only
};

inline constexpr double kElsewhere = 1.0; ///< metres; a larger error means another place

/// Judges an alignment.
/// @param truth  absent if the view is of another world; then every clear result is wrong
[[nodiscard]] Trial trial_of(std::uint64_t seed, const landmarks::Alignment& found, const std::optional<Pose2>& truth);

/// The results for scenes of one kind.
struct Trials {
    std::vector<Trial> each; ///< in the order of their seeds
    double seconds = 0.0;    ///< for all, with their creation, on all processors; the only part that differs each time

    [[nodiscard]] std::size_t count(Verdict verdict) const;
    /// Returns the largest distance and the largest angle among the right ones; 0 if there are none.
    [[nodiscard]] PoseError worst() const;
};

/// Tries scenes 0 to `scenes` - 1 of an experiment on several threads.
/// @param try_scene  takes a scene's seed; called on any thread
/// Errors: that of the first scene with an error, including its seed.
[[nodiscard]] Result<Trials> try_scenes(std::uint64_t experiment_seed, std::size_t scenes, const Now& now,
                                        const std::function<Result<Trial>(std::uint64_t seed)>& try_scene);

} // namespace scanloom::lab
