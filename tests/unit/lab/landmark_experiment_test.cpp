#include "lab/landmark_experiment.hpp"

#include "lab/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace scanloom::lab {
namespace {

using Pictures = std::map<std::string, tiles::Bytes>;

struct Experiment {
    LandmarkResults results;
    std::string report;
    Pictures pictures;
};

/// Runs the experiment with fewer readings, on a machine on which each operation takes `tick` (s).
Experiment run_with(LandmarkPlan plan, double tick = 0.001) {
    plan.readings_max = 50;
    Experiment made;
    double time = 0.0;
    const auto keep = [&](const std::string& file, const tiles::Bytes& png) -> Result<> {
        made.pictures[file] = png;
        return {};
    };
    const auto now = [&] { return time += tick; };
    made.results = run_landmark_experiment(plan, {now, keep, [](std::string_view) {}}).value();
    made.report = report_of(made.results);
    return made;
}

TEST(LandmarkExperiment, ReportIsDeterministicAndIndependentOfTime) {
    const auto first = run_with({.seed = 3}, 0.001);
    const auto again = run_with({.seed = 3}, 0.5);
    EXPECT_EQ(first.report, again.report);
    EXPECT_EQ(first.pictures, again.pictures);
    const auto other = run_with({.seed = 4});
    EXPECT_NE(first.report, other.report);
    EXPECT_NE(first.pictures, other.pictures);
}

TEST(LandmarkExperiment, FindsTheDoorAndComparesNeighbouringPlaces) {
    const auto [results, report, pictures] = run_with({.seed = 1});
    ASSERT_EQ(results.places.size(), 3U);
    EXPECT_EQ(pictures.size(), 3U);
    for (const auto& place : results.places) {
        const auto& door = place.door.comparison;
        EXPECT_GE(place.control.metrics.persistence, door.metrics.persistence) << "a moved door removes landmarks";
        EXPECT_GE(door.only_first, 1U) << "the wall with the door";
        EXPECT_GE(door.only_second, 2U) << "the door leaf and the lobby";
        EXPECT_EQ(door.metrics.matched + door.only_first, place.door.first.survey.landmarks.size());
        EXPECT_TRUE(pictures.contains(place.door.picture));
    }
    ASSERT_EQ(results.neighbours.size(), 6U);
    EXPECT_EQ(results.readings.size(), 1U);
    EXPECT_FALSE(results.recorded);
}

TEST(LandmarkExperiment, ComparesTheHalvesOfARecording) {
    sim::Random random(2);
    const auto room = sim::make_room();
    LandmarkPlan plan;
    plan.recorded = RecordedCapture{take_capture(room, {}, 7, sim::Noise{}, random), "c.bin", "fine"};
    const auto [results, report, pictures] = run_with(std::move(plan));
    ASSERT_TRUE(results.recorded);
    EXPECT_EQ(results.recorded->turns, 7U);
    EXPECT_EQ(results.recorded->all.points.size(), 7U * 360U);
    EXPECT_EQ(results.recorded->halves.first.points.size(), 3U * 360U);
    EXPECT_EQ(results.recorded->halves.second.points.size(), 4U * 360U);
    EXPECT_TRUE(pictures.contains("recording.png"));
}

TEST(LandmarkExperiment, PictureThatCannotBeStoredIsAnError) {
    const auto keep = [](const std::string&, const tiles::Bytes&) -> Result<> {
        return Error{Errc::kStoreFailed, "the disk is full"};
    };
    const auto results = run_landmark_experiment({}, {[] { return 0.0; }, keep, [](std::string_view) {}});
    ASSERT_FALSE(results);
    EXPECT_EQ(results.error().message, "the disk is full");
}

} // namespace
} // namespace scanloom::lab
