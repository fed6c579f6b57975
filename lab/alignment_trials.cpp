#include "lab/alignment_trials.hpp"

#include "robot_client/sim/standing_robot.hpp"
#include "server/landmarks/localization.hpp"

#include <memory>

namespace scanloom::lab {
namespace {

landmarks::ReferenceViews as_references(const std::vector<robot::StandingView>& views) {
    landmarks::ReferenceViews references;
    for (const auto& [from, points] : views) {
        references.push_back(std::make_shared<const landmarks::ReferenceView>(landmarks::ReferenceView{from, points}));
    }
    return references;
}

} // namespace

std::vector<robot::World> trial_worlds() {
    auto office = robot::make_office();
    office.starts = {{-15.0, -10.0, 15.0, 10.0}};
    return {robot::make_room(), std::move(office), robot::make_hall()};
}

Result<AlignmentTrials> try_alignment(const robot::World& world, std::uint64_t seed, std::size_t scenes,
                                      const Now& now) {
    const auto doors = robot::doors_of(world);
    auto trials = try_scenes(seed, scenes, now, [&](std::uint64_t scene) -> Result<Trial> {
        const auto captures = robot::two_captures(world, doors, scene);
        const auto found = landmarks::align({.points = captures.first}, {.points = captures.second});
        if (!found) return found.error();
        return trial_of(scene, *found, captures.T_first_second);
    });
    if (!trials) return trials.error();
    return AlignmentTrials{world.name, std::move(*trials)};
}

Result<LocatingTrials> try_locating(const robot::World& world, std::size_t captures, std::uint64_t seed,
                                    std::size_t scenes, const Now& now) {
    auto trials = try_scenes(seed, scenes, now, [&](std::uint64_t scene) -> Result<Trial> {
        const auto mapped = located_scene(world, captures, scene);
        const auto map = as_references(mapped.map);
        const auto found = landmarks::locate(map, {.points = mapped.seen});
        if (!found) return found.error();
        Trial trial = trial_of(scene, *found, mapped.truth);
        if (trial.verdict == Verdict::kWrong && trial.error.metres > kElsewhere) {
            const landmarks::Neighbourhood near_truth{{mapped.truth.x, mapped.truth.y}, kElsewhere};
            const auto at_truth = landmarks::locate(map, {.points = mapped.seen}, near_truth);
            if (!at_truth) return at_truth.error();
            trial.explained_at_truth = at_truth->explained;
        }
        return trial;
    });
    if (!trials) return trials.error();
    return LocatingTrials{world.name, world.name, captures, std::move(*trials)};
}

Result<LocatingTrials> try_strangers(const robot::World& seen, const robot::World& map, std::size_t captures,
                                     std::uint64_t seed, std::size_t scenes, const Now& now) {
    auto trials = try_scenes(seed, scenes, now, [&](std::uint64_t scene) -> Result<Trial> {
        robot::Random random(scene);
        const auto view = robot::standing_capture(seen, robot::free_place(seen, random), robot::kMappedTurns, random);
        const auto found = landmarks::locate(as_references(located_scene(map, captures, scene).map), {.points = view});
        if (!found) return found.error();
        return trial_of(scene, *found, std::nullopt);
    });
    if (!trials) return trials.error();
    return LocatingTrials{seen.name, map.name, captures, std::move(*trials)};
}

robot::MappedWorld located_scene(const robot::World& world, std::size_t captures, std::uint64_t scene_seed) {
    return robot::mapped_world(world, static_cast<int>(captures), scene_seed);
}

} // namespace scanloom::lab
