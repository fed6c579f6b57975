#pragma once

#include "robot_client/sources/carmen_observer.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/pose_path.hpp"
#include "robot_client/sources/scan_order.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// FLASER lines whose second pose is odometry state the laser's mount if it is constant within this.
inline constexpr double kConstantMountTolerance = 1e-3; // metres and radians

/// A source of the laser lines of a CARMEN log (plain, gzip or bzip2), in the order of the file. Only if parts of the
/// file are out of order in time, scans follow their ipc_timestamp (see ScanOrder). A line without a stamp takes that
/// of the line before it.
///
/// FLASER: scan.pose is the first triple (laser pose, often corrected), the mount is the identity, and scan.odometry is
/// the second triple.
/// ROBOTLASER: the mount is the laser's pose relative to the robot's. It is kept while it changes only by rounding, and
/// scan.pose is chosen so that pose * mount is the logged laser pose.
/// RAWLASER1: has no pose and is read only if the log has no other laser lines. The pose is interpolated between the
/// ODOM lines around it, and the mount is PARAM robot_frontlaser_offset.
/// This is so if the options' poses are kMap. With kOdometry, scan.odometry is the second triple of a FLASER line, the
/// robot's pose of a ROBOTLASER line, or the interpolated pose of a RAWLASER1 line, and scan.pose is absent. The mount
/// of a FLASER line is its first triple relative to its second if that is constant over the log, within
/// kConstantMountTolerance; otherwise the identity. With kNone the mounts are the same, but scans have neither pose nor
/// odometry; RAWLASER1 lines then need no ODOM lines.
/// Ranges are rounded to millimetres here, once. NaN and negative readings are invalid beams, infinite ones are
/// no-returns.
///
/// The file is read twice: open() determines the order of its scans, next() reads them as they are needed. Memory: some
/// bytes for each laser line, and the scans that precede earlier-sent ones in the file.
class CarmenLog final : public Source {
public:
    /// Reads the log once.
    /// @param report   called for each malformed line in the order of the file, then once for each unread kind of laser
    ///                 line, then for each RAWLASER line without a pose
    /// @param on_read  called after each chunk of the file
    /// Errors: those of LineReader; kNotFound if no line is usable; kTooLarge if there are more than 2^32 - 2 laser
    ///         lines.
    [[nodiscard]] static Result<CarmenLog> open(const std::filesystem::path& path, const CarmenOptions& options,
                                                const std::function<void(const SkippedLine&)>& report,
                                                const OnRead& on_read = {});

    /// Errors: those of LineReader; kConflict if the file has changed since open().
    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return index_.scan_count; }

    [[nodiscard]] std::size_t skipped_lines() const noexcept { return index_.skipped_lines; }
    [[nodiscard]] const StampReport& stamps() const noexcept { return index_.stamps; }
    /// Returns at most 64 printable bytes that are the same for the same scans, whatever the file's name and
    /// compression.
    [[nodiscard]] const std::string& fingerprint() const noexcept { return index_.fingerprint; }

private:
    class Indexer;

    struct Line {
        std::string_view text;      ///< valid until the next line
        Result<CarmenLine> content; ///< the error of a line that cannot be used
    };

    /// The lines of a log, one at a time.
    struct Lines {
        LineReader reader;
        double last_stamp = 0.0; ///< seconds, of the laser line before

        /// Reads the next line with content; a laser line without a stamp gets that of the laser line before.
        /// @return nullopt after the last line
        /// Errors: those of LineReader.
        [[nodiscard]] Result<std::optional<Line>> next();
    };

    /// The data of a whole log that are needed before its first scan can be sent. They are small, so a log may be
    /// large.
    struct Index {
        std::vector<std::uint32_t> places; ///< for each laser line, in the order of the file: its index among the scans
                                           ///< in sending order, from 0, or kUnused if the line is not sent
        std::uint32_t scan_count = 0;
        PosePath path; ///< only if the scans come from RAWLASER lines
        CarmenMounts mounts;
        std::size_t skipped_lines = 0;
        StampReport stamps;
        std::string fingerprint; ///< of the lines and options that determine the scans, and of their order
    };

    CarmenLog(const std::filesystem::path& path, const CarmenOptions& options, Index index, LineReader reader);

    [[nodiscard]] Result<CarmenScan> next_in_place();
    [[nodiscard]] Error changed() const;

    std::string path_;
    Index index_;
    Lines lines_;
    bool needs_poses_;
    CarmenObserver observer_;
    std::size_t laser_lines_ = 0;               ///< read so far
    std::uint32_t place_ = 0;                   ///< index of the next scan in sending order
    std::map<std::uint32_t, CarmenScan> early_; ///< read before they are sent, by their index in sending order
};

} // namespace scanloom::robot
