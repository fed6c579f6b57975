#pragma once

#include "lab/trials.hpp"

#include "robot_client/sim/mapped_world.hpp"

#include <array>
#include <string>
#include <vector>

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
