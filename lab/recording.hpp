#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "lab/matrix.hpp"
#include "sim/noise.hpp"
#include "sim/simulator.hpp"
#include "sim/world.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scanloom::lab {

/// Returns the size of the frames that a robot sends for some scans, in bytes: one Protocol Buffers batch per scan, as
/// during measurement, with length prefix and checksum.
[[nodiscard]] std::size_t robot_bytes(std::span<const Scan> scans);

/// Returns the bytes that survey_landmarks() holds while it clusters points: the points, the distinct ones among them,
/// the grid over these, and the data for each cell and each point. The value is computed from the sizes of the elements
/// with all points taken as core points; spare capacity of vectors and the search trees of crowded cells are not
/// included.
/// Pre: the points pass check_points(), and eps passes check_eps().
[[nodiscard]] std::size_t clustering_bytes(std::span<const Point2> points, double eps);

/// The room's centre in the map frame. With walls exactly on cell borders, the room would be a special case.
inline const Point2 kRoomMiddle{0.137, 0.163}; // metres

/// Returns a world of the simulator with its origin at kRoomMiddle.
/// Pre: the world exists.
[[nodiscard]] sim::World world_of(std::string_view name);

/// What a robot observed along its trajectory.
struct Recording {
    Sensor laser;
    std::vector<Scan> scans;                     ///< seq 1, 2, ...; with true poses
    std::vector<std::vector<sim::Disc>> walkers; ///< their positions, for each scan
    std::size_t of_walkers = 0;                  ///< readings of all scans, without their noise, that hit a walker
};

/// Returns the reference laser: 684 beams over -90..+90 degrees, 5 m.
[[nodiscard]] Sensor reference_laser();

/// Returns the trajectory of the wall follower in the static room without noise. Every run uses it, so that runs differ
/// only in what they vary. (Walkers avoid the robot: see scanloom::sim::walk().)
/// @return the pose of each scan
[[nodiscard]] std::vector<Pose2> drive_from(const Start& start, std::size_t scans);

/// Simulates the scans of a scene along a trajectory.
[[nodiscard]] Recording record(const Scene& scene, const std::vector<Pose2>& path, const NoiseChoice& noise,
                               double cell_size_m, std::uint64_t seed);

/// Scans of a stationary lidar: successive turns, all from one pose.
struct LidarCapture {
    Sensor sensor;
    std::vector<Scan> scans; ///< seq 1, 2, ...
};

/// Simulates turns of the simulator's "lidar360": 360 beams, 12 m, ten turns per second.
[[nodiscard]] LidarCapture take_capture(const sim::World& world, const Pose2& T_map_lidar, std::size_t turns,
                                        const std::optional<sim::Noise>& noise, sim::Random& random);

/// Returns the points hit by the beams, in the robot's frame: turn by turn, within a turn in the order of the beams.
[[nodiscard]] std::vector<Point2> points_of(std::span<const Scan> scans, const Sensor& sensor);

/// Returns the points of points_of() in the map frame, by the scans' poses.
[[nodiscard]] std::vector<Point2> points_in_map(std::span<const Scan> scans, const Sensor& sensor);

/// A recording of a real, stationary lidar.
struct RecordedCapture {
    LidarCapture capture; ///< all poses are 0: the map frame is the lidar's
    std::string name;     ///< file name without directories
    std::string remarks;  ///< what the decoder reports
};

/// Reads the bytes that an LD06 sent, decoded as by its robot client with default settings.
/// Errors: those of robot::Ld06Capture; kInvalidField: fewer than two turns, so there are no two halves to compare.
[[nodiscard]] Result<RecordedCapture> read_ld06_recording(const std::filesystem::path& path);

} // namespace scanloom::lab
