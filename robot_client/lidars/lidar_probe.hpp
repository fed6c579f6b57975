#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Find out which lidar is at the other end of a line. Requests are harmless: they stop a measurement, and ask what the
/// sensor is.
namespace scanloom::robot {

/// A lidar that has answered, or that sends by itself.
struct LidarIdentity {
    std::string model; ///< of lidar_models()
    std::string text;  ///< for people: what the sensor says of itself
    unsigned baud = 0; ///< at which it answered, if that is not the model's; else 0

    friend bool operator==(const LidarIdentity&, const LidarIdentity&) = default;
};

/// One attempt: some lidars at one rate of the line.
struct LidarProbe {
    unsigned baud = 0;
    std::vector<std::vector<std::uint8_t>> requests; ///< empty: lidars that send by themselves
    /// Returns the lidar that sent these bytes, or nullopt if more are needed.
    std::optional<LidarIdentity> (*identify)(std::span<const std::uint8_t> bytes);
};

/// Returns all attempts, in the order in which they are made.
[[nodiscard]] const std::vector<LidarProbe>& lidar_probes();

} // namespace scanloom::robot
