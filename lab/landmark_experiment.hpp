#pragma once

#include "lab/landmark_comparison.hpp"
#include "lab/recording.hpp"

#include "server/tiles/bytes.hpp"

#include <functional>
#include <optional>
#include <string>

namespace scanloom::lab {

/// Turns of each simulated capture, except in the sweep of readings, which takes as many as it needs.
inline constexpr std::size_t kTurns = 20;

/// Two captures in one frame and their comparison.
struct CapturePair {
    SeenLandmarks first;
    SeenLandmarks second;
    Comparison comparison; ///< with the default tolerance
    std::string picture;   ///< file name
};

/// Captures from one place while a door was moved.
struct PlaceResult {
    Pose2 place;        ///< T_map_lidar
    CapturePair door;   ///< first with the door closed, second with it open
    Comparison control; ///< the closed capture and another closed one: the effect of noise alone
};

/// Two neighbouring places.
struct NeighbourResult {
    std::size_t from = 0; ///< index of the place of the first capture
    std::size_t to = 0;
    bool door_moved = false; ///< closed in the first, open in the second; otherwise closed in both
    Comparison comparison;   ///< in the map frame, by the true poses
};

/// Results for a recording.
struct RecordedResult {
    std::string name; ///< as in RecordedCapture
    std::string remarks;
    std::size_t turns = 0;
    SeenLandmarks all;
    CapturePair halves; ///< the first and the second half of the turns
};

struct LandmarkResults {
    std::uint64_t seed = 1;
    std::vector<PlaceResult> places;
    std::vector<NeighbourResult> neighbours;
    std::vector<ToleranceRow> tolerances;
    std::vector<ReadingsRow> readings;
    std::vector<FilterRow> windows;
    std::optional<RecordedResult> recorded;
};

/// Interfaces to clock, files and display.
struct LandmarkSurroundings {
    Now now;
    std::function<Result<>(const std::string& file, const tiles::Bytes& png)> keep_picture;
    std::function<void(std::string_view doing)> on_part; ///< called before each part
};

struct LandmarkPlan {
    std::uint64_t seed = 1;                       ///< of the noise
    std::size_t readings_max = kReadings.back();  ///< of the sweep of readings; fewer take less time
    std::optional<RecordedCapture> recorded = {}; ///< absent: the report omits this part
};

/// Runs the whole experiment. All results except the times depend on the plan only.
/// Pre: a recording has at least two turns.
/// Errors: those of its parts and of keep_picture.
[[nodiscard]] Result<LandmarkResults> run_landmark_experiment(const LandmarkPlan& plan,
                                                              const LandmarkSurroundings& surroundings);

} // namespace scanloom::lab
