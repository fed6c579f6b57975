#pragma once

#include "server/landmarks/capture.hpp"
#include "server/landmarks/landmark_map.hpp"

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

/// What the landmarks of a session are, at one revision.
struct LandmarkState {
    LandmarkView landmarks;
    std::uint64_t captures = 0; ///< that have ended
    PairSums sums;
    Revision revision = 0; ///< of the last capture's end; 0: there is none
};

/// What a robot is in the middle of, as a checkpoint keeps it.
struct LandmarkRobot {
    std::optional<Capture> newest; ///< CaptureCutter::newest()
    bool is_open = false;
    std::optional<std::vector<Landmark>> seen_last; ///< by its last capture that has ended, if any has

    friend bool operator==(const LandmarkRobot&, const LandmarkRobot&) = default;
};

/// Landmarks as a layer of a session's maps: a fold of its log. Robots' scans are cut into captures, the landmarks of
/// each are found (models: adaptive eps, DBSCAN, medians) and matched with those that are known, and with those of the
/// robot's capture before.
/// Thread  one writer; what snapshot() gives is for everybody.
class LandmarkLayer {
public:
    /// Adds a scan of a laser. Robots are numbered from 0; one that was not seen before may be any of them.
    /// Pre  as CaptureCutter::add().
    void add(RobotIndex robot, const Scan& scan, const Sensor& sensor, Revision revision);

    [[nodiscard]] LandmarkState snapshot();
    [[nodiscard]] std::size_t block_count() const noexcept { return map_.block_count(); }

    /// A second one that goes on from here, with a writer of its own.
    [[nodiscard]] LandmarkLayer branch();

    /// What a checkpoint keeps besides snapshot(); robots behind the last one have begun no capture.
    [[nodiscard]] std::vector<LandmarkRobot> robots() const;

    /// Rebuilds a layer from a checkpoint: on a fresh one, first the blocks in their order, then the rest.
    void restore(detail::LandmarkBlock block) { map_.restore(std::move(block)); }
    void restore(std::uint64_t captures, const PairSums& sums, Revision revision, std::vector<LandmarkRobot> robots);

private:
    struct Robot {
        CaptureCutter cutter;
        std::optional<std::vector<Landmark>> seen_last;
    };

    void add(Robot& robot, const Capture& capture);

    LandmarkMap map_;
    std::vector<Robot> robots_;
    std::uint64_t captures_ = 0;
    PairSums sums_;
    Revision revision_ = 0;
};

} // namespace scanloom::landmarks
