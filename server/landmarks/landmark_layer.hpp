#pragma once

#include "server/landmarks/landmark_map.hpp"
#include "server/landmarks/session_captures.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// How alike what robots saw in succession was: sums over pairs of captures, each of one robot, the second behind the
/// first. What is divided by is beside it.
struct PairSums {
    std::uint64_t persistence_pairs = 0; ///< of which the first had landmarks
    double persistence = 0.0;
    std::uint64_t stability_pairs = 0; ///< of which landmarks matched
    double stability = 0.0;
    std::uint64_t landmarks = 0; ///< of all captures
    double continuity = 0.0;     ///< summed over them

    friend bool operator==(const PairSums&, const PairSums&) = default;
};

/// What the landmarks of a session are, at one moment.
struct LandmarkState {
    LandmarkView landmarks;
    std::uint64_t captures = 0;
    PairSums sums;
};

/// Landmarks of captures: those of each are found (models: adaptive eps, DBSCAN, medians) and matched with those that
/// are known, and with those of the robot's capture before.
/// Thread  one writer; what snapshot() gives is for everybody.
class LandmarkLayer {
public:
    /// Adds the next capture. Robots are numbered from 0; one that was not seen before may be any of them.
    void add(const RobotCapture& ended);

    /// Landmarks.
    [[nodiscard]] std::size_t size() const noexcept { return map_.size(); }
    [[nodiscard]] LandmarkState snapshot() { return {map_.snapshot(), captures_, sums_}; }

private:
    LandmarkMap map_;
    std::vector<std::optional<std::vector<Landmark>>> seen_last_; // by RobotIndex: in its last capture, if it had any
    std::uint64_t captures_ = 0;
    PairSums sums_;
};

} // namespace scanloom::landmarks
