#pragma once

#include "robot_client/source/carmen_index.hpp"
#include "robot_client/source/carmen_record.hpp"
#include "robot_client/source/source.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace scanloom::robot {

/// The laser lines of a CARMEN log (plain, gzip or bzip2) as a source, in the order of the file; only where parts of it
/// are out of their place in time, in that of their ipc_timestamp (see ScanOrder). A line without a time stamp takes
/// that of the line before it.
///
/// FLASER   scan.pose is the first triple (laser pose, often corrected) and the mount is the identity;
///          scan.odometry is the second triple.
/// ROBOTLASER   the mount is the laser's pose in the robot's; it is kept while it changes by rounding only, and
///          scan.pose is chosen so that pose * mount is the laser pose as logged.
/// RAWLASER1   carries no pose and is read only where the log has no other laser lines: the pose is interpolated
///          between the ODOM lines around it, the mount is PARAM robot_frontlaser_offset.
/// Ranges   rounded to millimetres here, once; NaN and negative readings are invalid beams, infinite ones saw nothing.
///
/// The file is read twice: open() learns the order of its scans, next() reads them as they are needed.
/// Memory  some bytes for each laser line, and the scans that stand in the file before ones that are sent earlier.
class CarmenLog final : public Source {
public:
    /// Errors  those of index_carmen_log().
    [[nodiscard]] static Result<CarmenLog> open(const std::filesystem::path& path, const CarmenOptions& options,
                                                const std::function<void(const SkippedLine&)>& report,
                                                const OnRead& on_read = {});

    /// Errors  those of LineReader; kConflict: the file is not any more what open() has read.
    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return index_.scan_count; }

    [[nodiscard]] std::size_t skipped_lines() const noexcept { return index_.skipped_lines; }
    [[nodiscard]] const StampReport& stamps() const noexcept { return index_.stamps; }
    /// At most 64 printable bytes; the same for the same scans, whatever the file's name and compression.
    [[nodiscard]] const std::string& fingerprint() const noexcept { return index_.fingerprint; }

private:
    CarmenLog(const std::filesystem::path& path, const CarmenOptions& options, CarmenIndex index,
              CarmenRecords records);

    [[nodiscard]] Result<StampedScan> next_in_place();
    [[nodiscard]] Error changed() const;

    std::string path_;
    CarmenIndex index_;
    CarmenRecords records_;
    CarmenObserver observer_;
    std::size_t laser_lines_ = 0;                ///< read so far
    std::uint32_t place_ = 0;                    ///< of the next scan
    std::map<std::uint32_t, StampedScan> early_; ///< read before they are sent, by their place
};

} // namespace scanloom::robot
