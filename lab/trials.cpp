#include "lab/trials.hpp"

#include "lab/each_index.hpp"

#include <fmt/format.h>

#include <algorithm>

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

} // namespace scanloom::lab
