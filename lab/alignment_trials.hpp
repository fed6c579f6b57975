#pragma once

#include "core/landmarks/alignment.hpp"
#include "lab/integrate_recording.hpp"
#include "lab/pose_error.hpp"
#include "sim/map_world.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
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

/// The scenes for trials of alignment and localization: the simulator's worlds, with a door that moves.
namespace scanloom::lab {

/// Returns the simulator's room, office and hall. In the office, robots may also start inside rooms.
[[nodiscard]] std::vector<robot::World> trial_worlds();

/// Numbers of captures in a map.
inline constexpr std::array<std::size_t, 3> kMapSizes{1, 4, 12};

struct AlignmentTrials {
    std::string world;
    Trials trials;
};

/// Aligns two captures of one world with align() in each scene; see robot::two_captures().
/// Errors: those of align() and try_scenes().
[[nodiscard]] Result<AlignmentTrials> try_alignment(const robot::World& world, std::uint64_t seed, std::size_t scenes,
                                                    const Now& now);

struct LocatingTrials {
    std::string seen; ///< the world of the view
    std::string map;  ///< the world of the map
    std::size_t captures = 0;
    Trials trials;
};

/// Localizes another view of a world in a map of `captures` captures of it, with locate(); see robot::mapped_world().
/// Errors: those of locate() and try_scenes().
[[nodiscard]] Result<LocatingTrials> try_locating(const robot::World& world, std::size_t captures, std::uint64_t seed,
                                                  std::size_t scenes, const Now& now);

/// Tries to localize views of the world `seen` in maps of the world `map`; the maps are those of try_locating().
[[nodiscard]] Result<LocatingTrials> try_strangers(const robot::World& seen, const robot::World& map,
                                                   std::size_t captures, std::uint64_t seed, std::size_t scenes,
                                                   const Now& now);

/// Returns the scene that try_locating() uses for the seed of a trial.
[[nodiscard]] robot::MappedWorld located_scene(const robot::World& world, std::size_t captures,
                                               std::uint64_t scene_seed);

/// A scene that was drawn as a picture.
struct LocatedPicture {
    std::string file;
    std::string world;
    std::size_t captures = 0;
    Trial trial;
};

/// Results for all kinds of scenes.
struct TrialResults {
    std::size_t scenes = 0; ///< of each kind
    std::vector<AlignmentTrials> aligned;
    std::vector<LocatingTrials> located;
    std::vector<LocatingTrials> strangers;
    std::optional<LocatedPicture> picture;
};

} // namespace scanloom::lab
