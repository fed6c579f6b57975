#pragma once

#include "robot_client/sources/ld06_packet.hpp"
#include "robot_client/sources/source.hpp"

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Compute the time of packets from the milliseconds that they contain, which wrap every 30 s.
namespace scanloom::robot {

/// Clock of a recording: seconds since its first packet. Packets may be missing for less than 15 s. Time never goes
/// back: if the milliseconds do (another recording was appended, or the sensor was restarted), it stands still.
class Ld06RecordingClock {
public:
    /// Returns the stamp of the next packet.
    [[nodiscard]] double stamp(std::uint16_t milliseconds);

private:
    std::optional<std::uint16_t> last_;
    std::uint64_t elapsed_ = 0; // milliseconds
};

/// Clock of a sensor that is read live: Unix time. Bytes arrive late by some milliseconds, which vary. The sensor's own
/// clock has no jitter, but it has no fixed origin and drifts. So a packet gets its time by the sensor's clock, set by
/// the packet of the last ten seconds that arrived with the least delay. The time of arrival also determines the number
/// of wraps, so any number of packets may have been lost.
class Ld06LiveClock {
public:
    /// Returns the stamp of the next packet.
    /// @param arrival  Unix seconds
    [[nodiscard]] double stamp(std::uint16_t milliseconds, double arrival);

    /// Resets the clock for another sensor, or for the same one after a restart.
    void restart() noexcept { is_set_ = false; }

private:
    void set(double offset, double arrival) noexcept;

    // Offsets are Unix time minus the sensor's time, in seconds. They differ by less than half a wrap.
    bool is_set_ = false;
    double least_before_ = 0.0; ///< within the previous window
    double least_ = 0.0;        ///< within the current window
    double window_begin_ = 0.0; ///< Unix seconds
};

struct Ld06Beam {
    std::int32_t step = 0; ///< clockwise from ahead, 0..kLd06StepsPerTurn - 1
    Ld06Point point;

    friend bool operator==(const Ld06Beam&, const Ld06Beam&) = default;
};

/// The points from one crossing of 0 degrees to the next.
struct Ld06Turn {
    double stamp = 0.0;          ///< seconds, of its middle
    std::vector<Ld06Beam> beams; ///< at least 1, with increasing steps
    double duration = 0.0;       ///< seconds from the first beam to the last, by the sensor's speed; 0: not known

    friend bool operator==(const Ld06Turn&, const Ld06Turn&) = default;
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
    [[nodiscard]] std::optional<Ld06Turn> next();

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
    void add_point(Ld06Beam beam, const Ld06Packet& packet, double stamp);
    [[nodiscard]] double duration() const;
    void end_turn();

    std::optional<Before> before_; ///< the previous packet
    bool is_given_ = false;        ///< the current turn will be given: it began at 0 degrees or after a gap
    bool is_part_ = false;         ///< the current turn was cut by a gap
    std::vector<Ld06Beam> beams_;
    double first_stamp_ = 0.0;
    double last_stamp_ = 0.0;
    std::uint64_t speeds_ = 0; ///< sum over the points of the turn, degrees per second
    std::deque<Ld06Turn> complete_;
    std::uint64_t count_ = 0;
    std::uint64_t parts_ = 0;
    std::uint64_t gaps_ = 0;
    std::uint64_t too_long_ = 0;
};

/// Counts of the turns that did not become scans.
struct Ld06Losses {
    std::uint64_t without_pose = 0;
    std::uint64_t too_many_waiting = 0; ///< dropped because next() was not called in time
};

/// Returns a summary for people: "3 damaged packets, 225 turns, 4 of them cut by 2 gaps", and further losses.
[[nodiscard]] std::string ld06_remarks(const Ld06Counts& counts, const Ld06Turns& turns, const Ld06Losses& losses);

/// Defaults are those of the sensor's data sheet unless a comment states another source.
struct Ld06ScanOptions {
    double range_min = 0.02; ///< metres; shorter readings are invalid
    double range_max = 12.0; ///< metres; readings of at least this length are no-returns
    NoReturn no_return = NoReturn::kFree;
    /// Readings of less confidence are invalid. In a real recording of a room with a stationary sensor, one in three
    /// readings below 100 lies more than 0.15 m from the median of its half degree, but fewer than 2 in 100 of the
    /// others do; fewer than 1 in 100 readings are below 100.
    std::uint8_t confidence_min = 100;
    std::optional<int> median_window; ///< beams, see median_filtered()
    Pose2 mount;                      ///< T_robot_sensor; the sensor's x axis is its 0 degrees
    Poses poses = Poses::kMap;        ///< what the robot's poses are
};

/// Returns the sensor's description for the server.
[[nodiscard]] std::shared_ptr<const Sensor> ld06_sensor(const Ld06ScanOptions& options);

/// Converts a turn into a scan without a pose.
///
/// Beams are in counter-clockwise order. The sensor turns clockwise, so the turn's last point is the first beam. Angles
/// are whole multiples of 0.01/11 degree, from 0 (excluded) to a full turn. The scan keeps common/scan/limits.hpp. A
/// distance of 0 becomes an invalid beam: the sensor saw nothing or could not measure.
[[nodiscard]] Scan ld06_scan(const Ld06Turn& turn, const Ld06ScanOptions& options);

} // namespace scanloom::robot
