#pragma once

#include "lab/matrix.hpp"

#include "robot_client/sim/simulator.hpp"

#include <vector>

namespace scanloom::lab {

/// Where the room's middle is in the map. Walls on the borders between cells would be a case of its own.
inline const Point2 kRoomMiddle{0.137, 0.163}; // metres

/// A world of the simulator, with its origin there. Pre: it exists.
[[nodiscard]] robot::World world_of(std::string_view name);

/// What a robot saw on its way.
struct Recording {
    Sensor laser;
    std::vector<Scan> scans;                       ///< seq 1, 2, ...; exact poses
    std::vector<std::vector<robot::Disc>> walkers; ///< where they stood, for each scan
    std::size_t of_walkers = 0;                    ///< readings of all scans, without their noise, that met one
};

/// The reference laser: 684 beams over -90..+90 degrees, 5 m.
[[nodiscard]] Sensor reference_laser();

/// Where the wall follower goes in the static room without noise. Every run drives this way, so that runs differ in
/// what they vary and in nothing else. (Walkers keep away from it: see scanloom::robot::walk().)
/// @return the pose of each scan.
[[nodiscard]] std::vector<Pose2> drive_from(const Start& start, std::size_t scans);

/// The scans of a scene taken along a path.
[[nodiscard]] Recording record(const Scene& scene, const std::vector<Pose2>& path, const NoiseChoice& noise,
                               double cell_size_m, std::uint64_t seed);

} // namespace scanloom::lab
