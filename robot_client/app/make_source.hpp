#pragma once

#include "robot_client/app/options.hpp"
#include "robot_client/app/progress.hpp"
#include "robot_client/foxglove/foxglove_source.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/locating_source.hpp"
#include "robot_client/sources/source.hpp"
#include "sim/robot/exploring_source.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct PreparedSource {
    std::unique_ptr<Source> source;           ///< a recording or simulation, or
    std::unique_ptr<LiveSource> live;         ///< a live source: exactly one of the two is set
    std::optional<std::size_t> skipped_lines; ///< of text files that were read
    std::optional<LeftOut> left_out;          ///< of a recording of ROS; see left_out_now()
    Poses poses = Poses::kMap;                ///< what the poses of its scans are
    double speed = 0.0;
    std::string fingerprint;                   ///< for Hello.source
    std::string_view order;                    ///< of a log's scans: "file" or "time", a literal; else empty
    sim::ExploringSource* exploring = nullptr; ///< set if it is `live`; needs ask_with()
    FoxgloveSource* foxglove = nullptr;        ///< set if it is `live`; needs survey_robot()
    LocatingSource* locating = nullptr;        ///< set if it is `live`; needs ask_with()
    std::optional<wire::Near> near;            ///< of `locating`: prior of the first place
    Point2 first_place{0.0, 0.0};              ///< of `locating`: the assumed first place if no map exists
    std::optional<double> body_radius;         ///< metres, of the robot that took the scans, if known

    /// Returns what was left out until now of a recording of ROS, or of a robot that is live.
    [[nodiscard]] std::optional<LeftOut> left_out_now() const {
        return foxglove != nullptr ? LeftOut{foxglove->skipped(), foxglove->lost_parts()} : left_out;
    }
    /// Returns the remarks of the source.
    [[nodiscard]] std::string remarks() const { return live ? live->remarks() : source->remarks(); }
};

/// Opens the recording, prepares a live source for the device, or sets up the simulation. Reports the first invalid
/// lines of a log or of poses, stamps that go back, and later events of a device to the console, which must outlive the
/// source.
/// Errors: those of CarmenLog::open(), RecordedScans::open(), SonarLog::open(), Ld06Capture::open(), read_pose_lines(),
///         make_simulated_robot() and make_foxglove(); kNotFound if the device does not exist; kInvalidField if options
///         contradict each other or a spool is given for a capture file.
[[nodiscard]] Result<PreparedSource> make_source(const RobotOptions& options, Console& console);

} // namespace scanloom::robot
