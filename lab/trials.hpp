#pragma once

#include "lab/pose_error.hpp"
#include "lab/weaving.hpp"

#include "server/landmarks/alignment.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// Alignments of many scenes that chance makes, and how often they are right.
namespace scanloom::lab {

/// Scenes of each kind.
inline constexpr std::size_t kScenes = 100;

/// The seed of a scene; scenes of different experiments are different ones.
[[nodiscard]] constexpr std::uint64_t scene_seed(std::uint64_t experiment_seed, std::size_t scene) {
    return experiment_seed * kScenes + scene;
}

enum class Verdict {
    kRight, ///< clear, and within kRightDistance and kRightDegrees of the truth
    kWrong, ///< clear, and not
    kAmbiguous,
    kUndetermined,
};
inline constexpr double kRightDistance = 0.02; ///< metres
inline constexpr double kRightDegrees = 0.5;

/// What came of one scene.
struct Trial {
    std::uint64_t seed = 0; ///< of the scene
    Verdict verdict = Verdict::kUndetermined;
    Pose2 found;
    PoseError error;
    double explained = 0.0;                   ///< see landmarks::Alignment
    std::optional<double> explained_at_truth; ///< of a wrong one that lies elsewhere: looked for near the truth alone
};

inline constexpr double kElsewhere = 1.0; ///< metres; what is further off lies in another place

/// @param truth  absent: there is none, as the view is of another world; then all that is clear is wrong
[[nodiscard]] Trial trial_of(std::uint64_t seed, const landmarks::Alignment& found, const std::optional<Pose2>& truth);

/// Scenes of one kind.
struct Trials {
    std::vector<Trial> each; ///< by their seeds
    double seconds = 0.0; ///< for all, their making included, on all processors: the only part that differs each time

    [[nodiscard]] std::size_t count(Verdict verdict) const;
    /// Of the right ones, each part for itself; 0 where none is.
    [[nodiscard]] PoseError worst() const;
};

/// Tries scenes 0 to `scenes` - 1 of an experiment, on several threads.
/// @param try_scene  of a scene's seed, on any thread
/// Errors  that of the first scene that has one, with its seed.
[[nodiscard]] Result<Trials> try_scenes(std::uint64_t experiment_seed, std::size_t scenes, const Now& now,
                                        const std::function<Result<Trial>(std::uint64_t seed)>& try_scene);

} // namespace scanloom::lab
