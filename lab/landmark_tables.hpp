#pragma once

#include "lab/document.hpp"
#include "lab/landmark_experiment.hpp"

/// The figures of the landmark experiment as tables. A figure without a value (a share of nothing) is a dash.
namespace scanloom::lab {

/// Returns the number of a place of kDoorRoomPlaces for people, from "1".
[[nodiscard]] std::string place_name(std::size_t index);

/// Returns the two places of a pair: "1 to 2".
[[nodiscard]] std::string pair_name(const NeighbourResult& neighbour);

/// Returns, for each place, the figures with the door moved and with nothing moved, and the published ones.
[[nodiscard]] Table door_table(const LandmarkResults& results);

/// Compares captures of neighbouring places like those of one place.
[[nodiscard]] Table neighbour_table(const LandmarkResults& results);

[[nodiscard]] Table tolerance_table(const LandmarkResults& results);
[[nodiscard]] Table readings_table(const LandmarkResults& results);
[[nodiscard]] Table readings_times_table(const LandmarkResults& results);
[[nodiscard]] Table window_table(const LandmarkResults& results);
[[nodiscard]] Table alignment_table(const LandmarkResults& results);

/// Lists the transforms from matched landmarks next to those from surfaces, for all pairs of captures.
[[nodiscard]] Table methods_table(const LandmarkResults& results);

/// Describes the whole recording, its halves and what they have in common.
[[nodiscard]] Table recording_table(const RecordedResult& recorded);
[[nodiscard]] Table halves_table(const RecordedResult& recorded);
[[nodiscard]] Table halves_methods_table(const RecordedResult& recorded);

} // namespace scanloom::lab
