#pragma once

#include "robot_client/sources/carmen_index.hpp"
#include "robot_client/sources/carmen_record.hpp"
#include "robot_client/sources/source.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace scanloom::robot {

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
/// Ranges are rounded to millimetres here, once. NaN and negative readings are invalid beams, infinite ones are
/// no-returns.
///
/// The file is read twice: open() determines the order of its scans, next() reads them as they are needed. Memory: some
/// bytes for each laser line, and the scans that precede earlier-sent ones in the file.
class CarmenLog final : public Source {
public:
    /// Errors: those of index_carmen_log().
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
    CarmenLog(const std::filesystem::path& path, const CarmenOptions& options, CarmenIndex index,
              CarmenRecords records);

    [[nodiscard]] Result<StampedScan> next_in_place();
    [[nodiscard]] Error changed() const;

    std::string path_;
    CarmenIndex index_;
    CarmenRecords records_;
    CarmenObserver observer_;
    std::size_t laser_lines_ = 0;                ///< read so far
    std::uint32_t place_ = 0;                    ///< index of the next scan in sending order
    std::map<std::uint32_t, StampedScan> early_; ///< read before they are sent, by their index in sending order
};

} // namespace scanloom::robot
