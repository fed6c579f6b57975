#include "lab/alignment_trials.hpp"

#include "core/landmarks/localization.hpp"
#include "lab/each_index.hpp"
#include "sim/standing_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace scanloom::lab {
namespace {

Verdict verdict_of(const landmarks::Alignment& found, const std::optional<PoseError>& error) {
    switch (found.certainty) {
    case landmarks::Certainty::kAmbiguous: return Verdict::kAmbiguous;
    case landmarks::Certainty::kUndetermined: return Verdict::kUndetermined;
    case landmarks::Certainty::kClear: break;
    }
    const bool is_right = error && error->metres <= kRightDistance && error->degrees() <= kRightDegrees;
    return is_right ? Verdict::kRight : Verdict::kWrong;
}

} // namespace

Trial trial_of(std::uint64_t seed, const landmarks::Alignment& found, const std::optional<Pose2>& truth) {
    std::optional<PoseError> error;
    if (truth) error = pose_error(found.T_first_second, *truth);
    return {seed, verdict_of(found, error), found.T_first_second, error.value_or(PoseError{}), found.explained, {}};
}

std::size_t Trials::count(Verdict verdict) const {
    return static_cast<std::size_t>(std::ranges::count(each, verdict, &Trial::verdict));
}

PoseError Trials::worst() const {
    PoseError worst;
    for (const Trial& trial : each) {
        if (trial.verdict != Verdict::kRight) continue;
        worst.metres = std::max(worst.metres, trial.error.metres);
        worst.radians = std::max(worst.radians, trial.error.radians);
    }
    return worst;
}

Result<Trials> try_scenes(std::uint64_t experiment_seed, std::size_t scenes, const Now& now,
                          const std::function<Result<Trial>(std::uint64_t seed)>& try_scene) {
    std::vector<std::optional<Result<Trial>>> tried(scenes);
    const double begun = now();
    for_each_index(scenes, [&](std::size_t n) { tried[n] = try_scene(scene_seed(experiment_seed, n)); });
    Trials trials{.each = {}, .seconds = now() - begun};
    for (std::size_t n = 0; n < scenes; ++n) {
        const Result<Trial>& trial = *tried[n];
        if (!trial) {
            return Error{trial.error().code,
                         fmt::format("scene {}: {}", scene_seed(experiment_seed, n), trial.error().message)};
        }
        trials.each.push_back(*trial);
    }
    return trials;
}

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
