#pragma once

#include "robot_client/source/carmen_line.hpp"
#include "robot_client/source/line_reader.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

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

} // namespace scanloom::robot
