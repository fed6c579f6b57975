#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/carmen_line.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::robot {

/// A laser line and its time: its own stamp, or that of the laser line before it.
struct StampedScan {
    CarmenScan scan;
    double stamp = 0.0; ///< finite
};

/// A line of a log with content, or the error of a line that cannot be used.
struct CarmenRecord {
    std::size_t line_number = 0;
    std::string_view text; ///< valid until the next record
    std::variant<StampedScan, CarmenOdometry, CarmenLaserOffset, CarmenUnreadLaser, Error> content;
};

/// The records of a CARMEN log in the order of the file, one at a time.
class CarmenRecords {
public:
    /// Errors: those of LineReader.
    [[nodiscard]] static Result<CarmenRecords> open(const std::filesystem::path& path, LineLimits limits,
                                                    OnRead on_read = {});

    /// Returns the next record, or nullopt after the last line.
    /// Errors: those of LineReader.
    [[nodiscard]] Result<std::optional<CarmenRecord>> next();

    [[nodiscard]] std::size_t line_count() const noexcept { return lines_.line_number(); } ///< read so far

private:
    explicit CarmenRecords(LineReader lines) : lines_(std::move(lines)) {}

    LineReader lines_;
    double last_stamp_ = 0.0;
};

struct CarmenOptions {
    /// Default: kFree if the log states its sensor's range (ROBOTLASER, RAWLASER), kDrop if it does not (FLASER).
    std::optional<NoReturn> no_return;
    /// Metres. Readings of at least this length are no-returns, as are those of the length that the log states.
    /// Default: kCarmenRangeMax.
    std::optional<double> range_max;
    LineLimits limits;
};

/// Logs write "no return" as 50, 80, 81.83, 81.91 ...: readings from 50 m on are no-returns unless the user sets
/// another limit.
inline constexpr double kCarmenRangeMax = 50.0;

/// Returns how beams without a return are used in lines of this kind.
[[nodiscard]] NoReturn no_return_of(CarmenKind kind, const CarmenOptions& options);

/// Checks whether a line can become a scan, as far as the line alone shows.
/// Errors: kInvalidField if it states a range that no sensor has; kTooLarge if its laser is too far from its robot.
[[nodiscard]] Result<> check_usable(const CarmenScan& line, const CarmenOptions& options);

/// Converts the lines of one log into scans of described sensors. Call observe() in order of time.
class CarmenObserver {
public:
    CarmenObserver(const CarmenOptions& options, double laser_offset_forward)
        : options_(options), laser_offset_forward_(laser_offset_forward) {}

    /// Converts one line. Pre: a RAWLASER line has the robot's pose filled in; `stamp` is finite.
    /// Errors: those of check_usable().
    [[nodiscard]] Result<Observation> observe(const CarmenScan& line, double stamp);

private:
    [[nodiscard]] std::vector<RangeMm> ranges_of(const CarmenScan& line, double range_max) const;
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_like(const Sensor& wanted);

    CarmenOptions options_;
    double laser_offset_forward_;
    std::vector<std::shared_ptr<const Sensor>> sensors_; ///< described so far, the newest last
};

} // namespace scanloom::robot
