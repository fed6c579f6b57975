#pragma once

#include "common/error/error.hpp"
#include "lab/trajectory_score.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace scanloom::lab {

/// The files of a recorded log.
struct LogFiles {
    std::string log;       ///< CARMEN log, plain, gzip or bzip2
    std::string relations; ///< file with verified relative poses
};

/// A recorded log in memory.
struct RecordedLog {
    std::string name;                      ///< see name_of_log()
    std::vector<robot::Observation> scans; ///< of lasers, with odometry and without poses, in the order of the log
    std::vector<Relation> relations;       ///< of the robot that took the scans
};

/// Returns the name of a log for headings and names of files: that of its file without folders, the ending of a
/// compression and one more ending. Characters other than ASCII letters, digits and '-' become '_'.
[[nodiscard]] std::string name_of_log(const std::string& path);

/// Reads a log and its relations.
/// Errors: those of read_relations() and robot::CarmenLog.
[[nodiscard]] Result<RecordedLog> read_recorded_log(const LogFiles& files);

/// Returns the raw odometry of a log: T_odom_robot at each scan.
[[nodiscard]] std::vector<robot::StampedPose> odometry_of(const RecordedLog& log);

/// The scans of a log, as a robot that knows its odometry or nothing of its poses sends them.
class LogReplay final : public robot::Source {
public:
    /// @param log    must outlive this object
    /// @param poses  kOdometry or kNone
    LogReplay(const RecordedLog& log, Poses poses) : log_(log), poses_(poses) {}

    /// Returns the next scan; it has no errors.
    [[nodiscard]] Result<std::optional<robot::Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return log_.scans.size(); }

private:
    const RecordedLog& log_;
    Poses poses_;
    std::size_t next_ = 0; // index of the next scan
};

} // namespace scanloom::lab
