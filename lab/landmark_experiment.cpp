#include "lab/landmark_experiment.hpp"

#include "lab/cloud_pictures.hpp"
#include "lab/door_room.hpp"

#include "sim/noise.hpp"

#include <fmt/format.h>

namespace scanloom::lab {
namespace {

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
        return take_capture(door == Door::kClosed ? closed_ : open_, place, turns, sim::Noise{}, random_);
    }

    [[nodiscard]] Result<> compare_doors();
    [[nodiscard]] Result<> add_place(std::size_t index);
    [[nodiscard]] Result<> compare_neighbours();
    [[nodiscard]] Result<> add_neighbour(std::size_t from, std::size_t to, bool door_moved);
    [[nodiscard]] Result<> sweep();
    [[nodiscard]] Result<> compare_halves(const RecordedCapture& recorded);
    [[nodiscard]] Result<> keep_picture(CapturePair& pair, const Point2& sensor, std::string file);

    const LandmarkPlan& plan_;
    const LandmarkSurroundings& surroundings_;
    sim::Random random_;
    const sim::World closed_ = make_door_room(Door::kClosed);
    const sim::World open_ = make_door_room(Door::kOpen);
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
    if (auto kept = keep_picture(*door, {place.x, place.y}, fmt::format("place_{}.png", index + 1)); !kept) return kept;
    results_.places.push_back({place, std::move(*door), std::move(*control)});
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
    results_.neighbours.push_back({from, to, door_moved, std::move(pair->comparison)});
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

Result<> Experiment::compare_halves(const RecordedCapture& recorded) {
    const auto& [sensor, scans] = recorded.capture;
    auto all = see(scans, sensor);
    if (!all) return all.error();
    const auto half = scans.size() / 2;
    auto halves = pair_of(see(std::span(scans).first(half), sensor), see(std::span(scans).subspan(half), sensor));
    if (!halves) return halves.error();
    const Pose2& place = *scans.front().pose;
    if (auto kept = keep_picture(*halves, {place.x, place.y}, "recording.png"); !kept) return kept;
    results_.recorded =
        RecordedResult{recorded.name, recorded.remarks, scans.size(), std::move(*all), std::move(*halves)};
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
