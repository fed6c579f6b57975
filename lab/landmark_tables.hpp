#pragma once

#include "lab/document.hpp"
#include "lab/landmark_experiment.hpp"

/// The figures of the landmark experiment as tables. What is nothing (a share of none) is a dash.
namespace scanloom::lab {

/// A place of kDoorRoomPlaces as people number them: "1".
[[nodiscard]] std::string place_name(std::size_t index);

/// The places of a way: "1 to 2".
[[nodiscard]] std::string way_name(const NeighbourResult& neighbour);

/// For each place the door moved, and nothing moved; and what is published.
[[nodiscard]] Table door_table(const LandmarkResults& results);

/// Captures of neighbouring places, compared as those of one place are.
[[nodiscard]] Table neighbour_table(const LandmarkResults& results);

[[nodiscard]] Table tolerance_table(const LandmarkResults& results);
[[nodiscard]] Table readings_table(const LandmarkResults& results);
[[nodiscard]] Table readings_times_table(const LandmarkResults& results);
[[nodiscard]] Table window_table(const LandmarkResults& results);
[[nodiscard]] Table alignment_table(const LandmarkResults& results);

/// The transform of the matched landmarks beside that of the surfaces, for all pairs of captures.
[[nodiscard]] Table ways_table(const LandmarkResults& results);

/// The whole recording, its halves and what they have in common.
[[nodiscard]] Table recording_table(const RecordedResult& recorded);
[[nodiscard]] Table halves_table(const RecordedResult& recorded);
[[nodiscard]] Table halves_ways_table(const RecordedResult& recorded);

} // namespace scanloom::lab
