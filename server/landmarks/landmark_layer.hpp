#pragma once

#include "server/landmarks/landmark_map.hpp"
#include "server/landmarks/session_captures.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// How consistent successive observations are: sums over pairs of successive keyframes of one robot. Each sum follows
/// the number to divide it by.
struct PairSums {
    std::uint64_t persistence_pairs = 0; ///< pairs whose first keyframe has landmarks
    double persistence = 0.0;
    std::uint64_t stability_pairs = 0; ///< pairs in which landmarks matched
    double stability = 0.0;
    std::uint64_t landmarks = 0; ///< of all keyframes
    double continuity = 0.0;     ///< sum over these landmarks

    friend bool operator==(const PairSums&, const PairSums&) = default;
};

/// The landmarks of a session at one moment.
struct LandmarkState {
    LandmarkView landmarks;
    std::uint64_t captures = 0;
    PairSums sums;
};

/// The landmarks of a session's keyframes. Finds the landmarks of each keyframe (adaptive eps, DBSCAN, medians) and
/// matches them with the known ones and with those of the same robot's previous keyframe.
/// Threads: one writer; any thread may use what snapshot() returned.
class LandmarkLayer {
public:
    /// Adds the next keyframe. Its robot may have any index, also one that was not seen before.
    void add(const RobotCapture& ended);

    /// Returns the number of landmarks.
    [[nodiscard]] std::size_t size() const noexcept { return map_.size(); }
    [[nodiscard]] LandmarkState snapshot() { return {map_.snapshot(), captures_, sums_}; }

private:
    LandmarkMap map_;
    std::vector<std::optional<std::vector<Landmark>>> seen_last_; // by RobotIndex: in the last keyframe, if any
    std::uint64_t captures_ = 0;
    PairSums sums_;
};

} // namespace scanloom::landmarks
