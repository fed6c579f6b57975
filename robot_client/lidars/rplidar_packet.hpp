#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// The packets of RPLIDARs: single points, and express capsules of 32.
/// Source: Slamtec, RPLIDAR interface protocol and application notes; Slamtec/rplidar_sdk where these are incomplete.
namespace scanloom::robot {

/// Angles are whole multiples of 1/64 degree, clockwise.
inline constexpr std::int32_t kRplidarStepsPerDegree = 64;
inline constexpr std::int32_t kRplidarStepsPerTurn = 360 * kRplidarStepsPerDegree;

inline constexpr std::size_t kRplidarNodeBytes = 5;
inline constexpr std::size_t kRplidarCapsuleBytes = 84;
inline constexpr std::size_t kRplidarCapsulePoints = 32;

struct RplidarPoint {
    bool starts_turn = false;
    std::int32_t step = 0;      ///< clockwise, 0 to kRplidarStepsPerTurn - 1
    std::uint16_t distance = 0; ///< quarters of a millimetre; 0 = no measurement
    std::uint8_t quality = 0;   ///< 0 to 63; capsules have none

    friend bool operator==(const RplidarPoint&, const RplidarPoint&) = default;
};

/// Decodes a single point.
/// @return nullopt if its check bits are wrong, or its angle is more than a turn
[[nodiscard]] std::optional<RplidarPoint> read_rplidar_node(std::span<const std::uint8_t, kRplidarNodeBytes> bytes);

/// A capsule with a correct checksum.
struct RplidarCapsule {
    bool is_first = false;  ///< of a measurement: it does not continue the previous one
    std::int32_t start = 0; ///< steps, clockwise, of the first point without its own correction
    struct Point {
        std::uint16_t distance = 0; ///< quarters of a millimetre, a multiple of 4
        std::uint8_t offset = 0;    ///< eighths of a degree, counter-clockwise

        friend bool operator==(const Point&, const Point&) = default;
    };
    std::array<Point, kRplidarCapsulePoints> points;

    friend bool operator==(const RplidarCapsule&, const RplidarCapsule&) = default;
};

/// Decodes a capsule.
/// @return nullopt if its marks or its checksum are wrong, or its angle is more than a turn
[[nodiscard]] std::optional<RplidarCapsule>
read_rplidar_capsule(std::span<const std::uint8_t, kRplidarCapsuleBytes> bytes);

/// Returns the points of a capsule, which are evenly spread until the start of the next one. A turn starts with the
/// first point at or after 0 degrees, by the angles without corrections.
/// @param angle  in: that of the point before, steps, or nullopt if it is not known; out: that of the last point
[[nodiscard]] std::array<RplidarPoint, kRplidarCapsulePoints>
points_of(const RplidarCapsule& capsule, const RplidarCapsule& next, std::optional<std::int32_t>& angle);

/// Finds the points in a stream of bytes, however it is split. Single points have only three check bits. Therefore,
/// after a damaged one, the search goes on until several follow one another.
class RplidarDecoder {
public:
    /// @param is_express  the stream has capsules
    explicit RplidarDecoder(bool is_express) : is_express_(is_express) {}

    void feed(std::span<const std::uint8_t> bytes);

    /// Returns the next point of the bytes fed, or nullopt if more bytes are needed.
    [[nodiscard]] std::optional<RplidarPoint> next();

    /// Returns the number of points or capsules that were damaged.
    [[nodiscard]] std::uint64_t damaged() const noexcept { return damaged_; }

private:
    [[nodiscard]] bool find_node();
    [[nodiscard]] bool read_capsule();
    void lose();

    bool is_express_;
    bool is_in_step_ = true; ///< a packet begins at begin_, unless it is damaged
    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0; ///< start of the bytes not examined
    std::optional<RplidarCapsule> before_;
    std::optional<std::int32_t> angle_; ///< of the newest point of a capsule, without its own correction
    std::array<RplidarPoint, kRplidarCapsulePoints> points_; ///< of the capsule before
    std::size_t given_ = kRplidarCapsulePoints;              ///< of points_
    std::uint64_t damaged_ = 0;
};

} // namespace scanloom::robot
