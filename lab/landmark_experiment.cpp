#include "lab/landmark_experiment.hpp"

#include "lab/cloud_pictures.hpp"
#include "lab/door_room.hpp"

#include "sim/noise.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::lab {
namespace {

// indices into trial_worlds()
constexpr std::size_t kStranger = 0; // the room, whose views are searched in maps of other worlds
constexpr std::size_t kDrawnMap = 1; // the office

/// The captures from one place.
struct PlaceCaptures {
    LidarCapture closed;
    LidarCapture closed_again;
    LidarCapture open;
};

class Experiment {
public:
    Experiment(const LandmarkPlan& plan, const LandmarkSurroundings& surroundings)
        : plan_(plan), surroundings_(surroundings), random_(plan.seed) {
        results_.seed = plan.seed;
    }

    [[nodiscard]] Result<LandmarkResults> run();

private:
    [[nodiscard]] LidarCapture take(Door door, const Pose2& place, std::size_t turns = kTurns) {
        return take_capture(door == Door::kClosed ? closed_ : open_, place, turns, robot::Noise{}, random_);
    }

    [[nodiscard]] Result<> compare_doors();
    [[nodiscard]] Result<> add_place(std::size_t index);
    [[nodiscard]] Result<> compare_neighbours();
    [[nodiscard]] Result<> add_neighbour(std::size_t from, std::size_t to, bool door_moved);
    [[nodiscard]] Result<> sweep();
    [[nodiscard]] Result<> try_alignments(TrialResults& trials);
    [[nodiscard]] Result<> try_maps(TrialResults& trials, std::size_t captures);
    [[nodiscard]] Result<> keep_located_picture(TrialResults& trials);
    [[nodiscard]] Result<> compare_halves(const RecordedCapture& recorded);
    [[nodiscard]] Result<> keep_picture(CapturePair& pair, const Point2& sensor, std::string file);

    const LandmarkPlan& plan_;
    const LandmarkSurroundings& surroundings_;
    robot::Random random_;
    const robot::World closed_ = make_door_room(Door::kClosed);
    const robot::World open_ = make_door_room(Door::kOpen);
    const std::vector<robot::World> worlds_ = trial_worlds();
    std::vector<PlaceCaptures> captures_;
    LandmarkResults results_;
};

Result<SeenLandmarks> see(std::span<const Scan> scans, const Sensor& sensor) {
    return see_landmarks(points_in_map(scans, sensor));
}

Result<CapturePair> pair_of(Result<SeenLandmarks> first, Result<SeenLandmarks> second) {
    if (!first) return first.error();
    if (!second) return second.error();
    auto comparison = compare(*first, *second);
    if (!comparison) return comparison.error();
    return CapturePair{std::move(*first), std::move(*second), std::move(*comparison), ""};
}

Result<LandmarkResults> Experiment::run() {
    surroundings_.on_part("a door, closed and open, from three places");
    for (const Pose2& place : kDoorRoomPlaces) {
        captures_.push_back({take(Door::kClosed, place), take(Door::kClosed, place), take(Door::kOpen, place)});
    }
    if (auto done = compare_doors(); !done) return done.error();
    surroundings_.on_part("captures of neighbouring places");
    if (auto done = compare_neighbours(); !done) return done.error();
    surroundings_.on_part("the sweeps");
    if (auto done = sweep(); !done) return done.error();
    if (plan_.scenes > 0) {
        TrialResults& trials = results_.trials.emplace(TrialResults{.scenes = plan_.scenes});
        if (auto done = try_alignments(trials); !done) return done.error();
        for (const std::size_t captures : kMapSizes) {
            if (captures > plan_.captures_max) break;
            if (auto done = try_maps(trials, captures); !done) return done.error();
        }
        if (auto done = keep_located_picture(trials); !done) return done.error();
    }
    if (plan_.recorded) {
        surroundings_.on_part("the recording");
        if (auto done = compare_halves(*plan_.recorded); !done) return done.error();
    }
    return std::move(results_);
}

Result<> Experiment::compare_doors() {
    for (std::size_t index = 0; index < captures_.size(); ++index) {
        if (auto added = add_place(index); !added) return added.error();
    }
    return {};
}

Result<> Experiment::add_place(std::size_t index) {
    const auto& [closed, closed_again, open] = captures_[index];
    auto again = see(closed_again.scans, closed.sensor);
    if (!again) return again.error();
    auto door = pair_of(see(closed.scans, closed.sensor), see(open.scans, open.sensor));
    if (!door) return door.error();
    auto control = compare(door->first, *again);
    if (!control) return control.error();
    const Pose2& place = kDoorRoomPlaces[index];
    auto door_methods = align_by_both_methods({door->first, door->second, place, place}, door->comparison.matches);
    if (!door_methods) return door_methods.error();
    auto control_methods = align_by_both_methods({door->first, *again, place, place}, control->matches);
    if (!control_methods) return control_methods.error();
    if (auto kept = keep_picture(*door, {place.x, place.y}, fmt::format("place_{}.png", index + 1)); !kept) return kept;
    results_.places.push_back(
        {place, std::move(*door), std::move(*control), std::move(*door_methods), std::move(*control_methods)});
    return {};
}

Result<> Experiment::compare_neighbours() {
    for (const bool door_moved : {false, true}) {
        for (std::size_t from = 0; from < captures_.size(); ++from) {
            const std::size_t to = (from + 1) % captures_.size();
            if (auto added = add_neighbour(from, to, door_moved); !added) return added.error();
        }
    }
    return {};
}

Result<> Experiment::add_neighbour(std::size_t from, std::size_t to, bool door_moved) {
    const LidarCapture& first = captures_[from].closed;
    const LidarCapture& second = door_moved ? captures_[to].open : captures_[to].closed;
    auto pair = pair_of(see(first.scans, first.sensor), see(second.scans, second.sensor));
    if (!pair) return pair.error();
    auto methods = align_by_both_methods({pair->first, pair->second, kDoorRoomPlaces[from], kDoorRoomPlaces[to]},
                                         pair->comparison.matches);
    if (!methods) return methods.error();
    results_.neighbours.push_back({.from = from,
                                   .to = to,
                                   .door_moved = door_moved,
                                   .comparison = std::move(pair->comparison),
                                   .methods = std::move(*methods)});
    return {};
}

Result<> Experiment::sweep() {
    std::vector<std::pair<const SeenLandmarks*, const SeenLandmarks*>> pairs;
    for (const PlaceResult& place : results_.places) pairs.emplace_back(&place.door.first, &place.door.second);
    auto tolerances = sweep_tolerances(pairs);
    if (!tolerances) return tolerances.error();
    results_.tolerances = std::move(*tolerances);

    const Pose2& place = kDoorRoomPlaces.front();
    auto readings = sweep_readings(take(Door::kClosed, place, plan_.readings_max), surroundings_.now);
    if (!readings) return readings.error();
    results_.readings = std::move(*readings);

    const auto without_noise = take_capture(closed_, place, 1, std::nullopt, random_).scans.front();
    results_.windows = sweep_windows(captures_.front().closed, without_noise);
    return {};
}

Result<> Experiment::try_alignments(TrialResults& trials) {
    for (const robot::World& world : worlds_) {
        surroundings_.on_part(fmt::format("{} alignments in the {}", plan_.scenes, world.name));
        auto row = try_alignment(world, plan_.seed, plan_.scenes, surroundings_.now);
        if (!row) return row.error();
        trials.aligned.push_back(std::move(*row));
    }
    return {};
}

Result<> Experiment::try_maps(TrialResults& trials, std::size_t captures) {
    for (const robot::World& world : worlds_) {
        surroundings_.on_part(
            fmt::format("{} views in maps of the {}, captures: {}", plan_.scenes, world.name, captures));
        auto row = try_locating(world, captures, plan_.seed, plan_.scenes, surroundings_.now);
        if (!row) return row.error();
        trials.located.push_back(std::move(*row));
    }
    const robot::World& seen = worlds_[kStranger];
    const robot::World& map = worlds_[kDrawnMap];
    surroundings_.on_part(
        fmt::format("{} views of the {} in maps of the {}, captures: {}", plan_.scenes, seen.name, map.name, captures));
    auto row = try_strangers(seen, map, captures, plan_.seed, plan_.scenes, surroundings_.now);
    if (!row) return row.error();
    trials.strangers.push_back(std::move(*row));
    return {};
}

/// Draws the first right result in the largest map of the office.
Result<> Experiment::keep_located_picture(TrialResults& trials) {
    const robot::World& world = worlds_[kDrawnMap];
    const auto last =
        std::ranges::find(trials.located.rbegin(), trials.located.rend(), world.name, &LocatingTrials::map);
    if (last == trials.located.rend()) return {};
    const auto right = std::ranges::find(last->trials.each, Verdict::kRight, &Trial::verdict);
    if (right == last->trials.each.end()) return {};
    trials.picture = LocatedPicture{"located.png", world.name, last->captures, *right};
    return surroundings_.keep_picture(trials.picture->file,
                                      located_png(located_scene(world, last->captures, right->seed), right->found));
}

Result<> Experiment::compare_halves(const RecordedCapture& recorded) {
    const auto& [sensor, scans] = recorded.capture;
    auto all = see(scans, sensor);
    if (!all) return all.error();
    const auto half = scans.size() / 2;
    auto halves = pair_of(see(std::span(scans).first(half), sensor), see(std::span(scans).subspan(half), sensor));
    if (!halves) return halves.error();
    const Pose2& place = scans.front().pose;
    auto methods = align_by_both_methods({halves->first, halves->second, place, place}, halves->comparison.matches);
    if (!methods) return methods.error();
    if (auto kept = keep_picture(*halves, {place.x, place.y}, "recording.png"); !kept) return kept;
    results_.recorded = RecordedResult{recorded.name,   recorded.remarks,   scans.size(),
                                       std::move(*all), std::move(*halves), std::move(*methods)};
    return {};
}

Result<> Experiment::keep_picture(CapturePair& pair, const Point2& sensor, std::string file) {
    pair.picture = std::move(file);
    return surroundings_.keep_picture(pair.picture,
                                      comparison_png(pair.first, pair.second, pair.comparison.matches, sensor));
}

} // namespace

Result<LandmarkResults> run_landmark_experiment(const LandmarkPlan& plan, const LandmarkSurroundings& surroundings) {
    return Experiment(plan, surroundings).run();
}

} // namespace scanloom::lab
