#pragma once

#include "lab/trials.hpp"

#include "robot_client/sim/mapped_world.hpp"

#include <array>
#include <string>
#include <vector>

/// The scenes on which alignment and locating are tried: the simulator's worlds, with a door that moves.
namespace scanloom::lab {

/// The simulator's room, office and hall; robots may stand in the rooms of the office, too.
[[nodiscard]] std::vector<robot::World> trial_worlds();

/// Captures of a map.
inline constexpr std::array<std::size_t, 3> kMapSizes{1, 4, 12};

struct AlignmentTrials {
    std::string world;
    Trials trials;
};

/// Two captures of one world, see robot::two_captures(), and align().
/// Errors  those of align() and try_scenes().
[[nodiscard]] Result<AlignmentTrials> try_alignment(const robot::World& world, std::uint64_t seed, std::size_t scenes,
                                                    const Now& now);

struct LocatingTrials {
    std::string seen; ///< the world that the view is of
    std::string map;  ///< the world that is mapped
    std::size_t captures = 0;
    Trials trials;
};

/// A map of so many captures and another view of that world, see robot::mapped_world(), and locate().
/// Errors  those of locate() and try_scenes().
[[nodiscard]] Result<LocatingTrials> try_locating(const robot::World& world, std::size_t captures, std::uint64_t seed,
                                                  std::size_t scenes, const Now& now);

/// The same maps, and a view of another world.
[[nodiscard]] Result<LocatingTrials> try_strangers(const robot::World& seen, const robot::World& map,
                                                   std::size_t captures, std::uint64_t seed, std::size_t scenes,
                                                   const Now& now);

/// The scene that try_locating() has for the seed of a trial.
[[nodiscard]] robot::MappedWorld located_scene(const robot::World& world, std::size_t captures,
                                               std::uint64_t scene_seed);

/// A scene that was drawn.
struct LocatedPicture {
    std::string file;
    std::string world;
    std::size_t captures = 0;
    Trial trial;
};

/// All kinds of scenes.
struct TrialResults {
    std::size_t scenes = 0; ///< of each kind
    std::vector<AlignmentTrials> aligned;
    std::vector<LocatingTrials> located;
    std::vector<LocatingTrials> strangers;
    std::optional<LocatedPicture> picture;
};

} // namespace scanloom::lab
