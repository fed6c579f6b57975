#pragma once

#include "robot_client/lidars/ld06_packet.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"
#include "robot_client/lidars/lidar_turn.hpp"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

/// Turn the packets of an LD06 into turns and scans.
namespace scanloom::robot {

/// Clock of a recording: seconds since its first packet, by the milliseconds of the packets, which wrap every 30 s.
/// Packets may be missing for less than 15 s. Time never goes back: if the milliseconds do (another recording was
/// appended, or the sensor was restarted), it stands still.
class Ld06RecordingClock {
public:
    /// Returns the stamp of the next packet.
    [[nodiscard]] double stamp(std::uint16_t milliseconds);

private:
    std::optional<std::uint16_t> last_;
    std::uint64_t elapsed_ = 0; // milliseconds
};

/// Cuts packets into turns exactly where the angle crosses 0, also within packets. The number of points of a turn
/// varies. No direction occurs twice: a point that is not ahead of the previous one is dropped.
///
/// The incomplete turns at the beginning and at the end of the stream are dropped. A turn with lost packets has a hole
/// there. If a whole turn may be missing, or angle and time disagree (another stream follows), there is a gap: the turn
/// ends with the points it has, and the points after the gap begin another one. Such parts of turns are given too,
/// because their measurements cannot be repeated.
class Ld06Turns {
public:
    /// @param stamp  of this packet, seconds
    void add(const Ld06Packet& packet, double stamp);

    /// Returns the next complete turn.
    [[nodiscard]] std::optional<LidarTurn> next();

    /// Starts a new stream.
    void restart();

    /// Returns the number of turns given, including parts, without those of more than kBeamsMax points.
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    /// Returns how many of these turns were cut by a gap.
    [[nodiscard]] std::uint64_t parts() const noexcept { return parts_; }
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }
    /// Returns the number of turns with more than kBeamsMax points. They are dropped: the sensor turns far too slowly.
    [[nodiscard]] std::uint64_t too_long() const noexcept { return too_long_; }

private:
    struct Before {
        std::int32_t start = 0; ///< steps within the current turn
        std::uint16_t timestamp = 0;
    };

    [[nodiscard]] std::optional<std::int32_t> follow(const Ld06Packet& packet) const;
    void add_point(LidarBeam beam, const Ld06Packet& packet, double stamp);
    [[nodiscard]] double duration() const;
    void end_turn();

    std::optional<Before> before_; ///< the previous packet
    bool is_given_ = false;        ///< the current turn will be given: it began at 0 degrees or after a gap
    bool is_part_ = false;         ///< the current turn was cut by a gap
    std::vector<LidarBeam> beams_;
    double first_stamp_ = 0.0;
    double last_stamp_ = 0.0;
    std::uint64_t speeds_ = 0; ///< sum over the points of the turn, degrees per second
    std::deque<LidarTurn> complete_;
    std::uint64_t count_ = 0;
    std::uint64_t parts_ = 0;
    std::uint64_t gaps_ = 0;
    std::uint64_t too_long_ = 0;
};

/// Returns the counts of a stream for people.
[[nodiscard]] LidarCounts ld06_counts(const Ld06Counts& packets, const Ld06Turns& turns) noexcept;

/// Returns the description of an LD06 for the server.
[[nodiscard]] std::shared_ptr<const Sensor> ld06_sensor(const LidarScanOptions& options);

/// Converts a turn into a scan without a pose, see lidar_scan(). Angles are whole multiples of 0.01/11 degree.
[[nodiscard]] Scan ld06_scan(const LidarTurn& turn, const LidarScanOptions& options);

} // namespace scanloom::robot
