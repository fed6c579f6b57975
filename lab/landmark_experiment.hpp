#pragma once

#include "lab/alignment_trials.hpp"
#include "lab/landmark_sweeps.hpp"
#include "lab/ld06_recording.hpp"
#include "lab/ways_to_align.hpp"

#include "server/tiles/bytes.hpp"

#include <functional>
#include <optional>
#include <string>

namespace scanloom::lab {

/// Turns of each simulated capture, but for that of the sweep of readings, which has as many as the sweep needs.
inline constexpr std::size_t kTurns = 20;

/// Two captures in one frame, and how alike they are.
struct CapturePair {
    SeenLandmarks first;
    SeenLandmarks second;
    Comparison comparison; ///< with the default tolerance
    std::string picture;   ///< name of its file
};

/// A lidar stood at one place while a door was moved.
struct PlaceResult {
    Pose2 place;        ///< T_map_lidar
    CapturePair door;   ///< first with the door closed, then with it open
    Comparison control; ///< the closed capture with another one, the door still closed: what noise alone changes
    WaysToAlign door_ways;
    WaysToAlign control_ways;
};

/// Two places beside each other.
struct NeighbourResult {
    std::size_t from = 0; ///< index of the place that the first capture was taken from
    std::size_t to = 0;
    bool door_moved = false; ///< closed in the first, open in the second; or else closed in both
    Comparison comparison;   ///< in the map frame, by the true poses
    WaysToAlign ways;
};

/// What a recording shows.
struct RecordedResult {
    std::string name; ///< as in RecordedCapture
    std::string remarks;
    std::size_t turns = 0;
    SeenLandmarks all;
    CapturePair halves; ///< the first half of the turns and the second
    WaysToAlign ways;   ///< of the halves, the truth being that it stood still
};

struct LandmarkResults {
    std::uint64_t seed = 1;
    std::vector<PlaceResult> places;
    std::vector<NeighbourResult> neighbours;
    std::vector<ToleranceRow> tolerances;
    std::vector<ReadingsRow> readings;
    std::vector<FilterRow> windows;
    std::optional<TrialResults> trials;
    std::optional<RecordedResult> recorded;
};

/// How the world outside takes part.
struct LandmarkSurroundings {
    Now now;
    std::function<Result<>(const std::string& file, const tiles::Bytes& png)> keep_picture;
    std::function<void(std::string_view doing)> on_part; ///< before each part
};

struct LandmarkPlan {
    std::uint64_t seed = 1;                       ///< of the noise, and of the scenes
    std::size_t readings_max = kReadings.back();  ///< of the sweep of readings; less takes less time
    std::size_t scenes = kScenes;                 ///< of each kind; 0: the report has no part about them
    std::size_t captures_max = kMapSizes.back();  ///< of a map that a view is located in; fewer take less time
    std::optional<RecordedCapture> recorded = {}; ///< absent: the report has no part about one
};

/// Does the whole experiment. Everything but the times follows from the plan.
/// Pre     a recording has two turns at least.
/// Errors  those of its parts and of keep_picture.
[[nodiscard]] Result<LandmarkResults> run_landmark_experiment(const LandmarkPlan& plan,
                                                              const LandmarkSurroundings& surroundings);

} // namespace scanloom::lab
