#pragma once

#include "lab/matrix.hpp"

#include "robot_client/sim/simulator.hpp"

#include <vector>

namespace scanloom::lab {

/// The room's centre in the map frame. With walls exactly on cell borders, the room would be a special case.
inline const Point2 kRoomMiddle{0.137, 0.163}; // metres

/// Returns a world of the simulator with its origin at kRoomMiddle.
/// Pre: the world exists.
[[nodiscard]] robot::World world_of(std::string_view name);

/// What a robot observed along its trajectory.
struct Recording {
    Sensor laser;
    std::vector<Scan> scans;                       ///< seq 1, 2, ...; with true poses
    std::vector<std::vector<robot::Disc>> walkers; ///< their positions, for each scan
    std::size_t of_walkers = 0;                    ///< readings of all scans, without their noise, that hit a walker
};

/// Returns the reference laser: 684 beams over -90..+90 degrees, 5 m.
[[nodiscard]] Sensor reference_laser();

/// Returns the trajectory of the wall follower in the static room without noise. Every run uses it, so that runs differ
/// only in what they vary. (Walkers avoid the robot: see scanloom::robot::walk().)
/// @return the pose of each scan
[[nodiscard]] std::vector<Pose2> drive_from(const Start& start, std::size_t scans);

/// Simulates the scans of a scene along a trajectory.
[[nodiscard]] Recording record(const Scene& scene, const std::vector<Pose2>& path, const NoiseChoice& noise,
                               double cell_size_m, std::uint64_t seed);

} // namespace scanloom::lab
