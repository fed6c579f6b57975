#pragma once

#include "robot_client/lidars/lidar_turn.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// The packets of YDLIDARs that measure by triangulation: X2, X4.
/// Source: YDLIDAR, X4 development manual; YDLidar-SDK Communication Protocol.
namespace scanloom::robot {

/// Angles are rounded to 1/64 degree, clockwise.
inline constexpr std::int32_t kYdlidarStepsPerDegree = 64;
inline constexpr std::int32_t kYdlidarStepsPerTurn = 360 * kYdlidarStepsPerDegree;

struct YdlidarPacket {
    bool starts_turn = false;     ///< with its first beam
    std::vector<LidarBeam> beams; ///< at least 1; without a confidence

    friend bool operator==(const YdlidarPacket&, const YdlidarPacket&) = default;
};

/// Returns the angle, clockwise in degrees, from the direction that a packet states to that of an obstacle: the
/// sensor's camera is next to its laser.
/// @param distance  millimetres; 0 = no measurement
[[nodiscard]] double ydlidar_correction(double distance) noexcept;

/// Finds the packets in a stream of bytes, however it is split and whatever is between them. If a header is not
/// followed by a complete packet, the search continues at the next byte.
class YdlidarDecoder {
public:
    void feed(std::span<const std::uint8_t> bytes);

    /// Returns the next packet of the bytes fed, or nullopt if more bytes are needed.
    [[nodiscard]] std::optional<YdlidarPacket> next();

    /// Starts a new stream. The count continues.
    void restart() noexcept { bytes_.clear(), begin_ = 0; }

    /// Returns the number of headers that were not followed by a packet with a correct check code.
    [[nodiscard]] std::uint64_t damaged() const noexcept { return damaged_; }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0; ///< start of the bytes not examined
    std::uint64_t damaged_ = 0;
};

} // namespace scanloom::robot
