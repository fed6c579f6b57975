#pragma once

#include "robot_client/source/ld06_packet.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace scanloom::robot {

struct Ld06Beam {
    std::int32_t step = 0; ///< clockwise from ahead, 0..kLd06StepsPerTurn - 1
    Ld06Point point;

    friend bool operator==(const Ld06Beam&, const Ld06Beam&) = default;
};

/// The points from one crossing of 0 degrees to the next.
struct Ld06Turn {
    double stamp = 0.0;          ///< seconds, of its middle: one pose is used for all its beams
    std::vector<Ld06Beam> beams; ///< at least 1, with increasing steps

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
    void add_point(Ld06Beam beam, double stamp);
    void end_turn();

    std::optional<Before> before_; ///< the previous packet
    bool is_given_ = false;        ///< the current turn will be given: it began at 0 degrees or after a gap
    bool is_part_ = false;         ///< the current turn was cut by a gap
    std::vector<Ld06Beam> beams_;
    double first_stamp_ = 0.0;
    double last_stamp_ = 0.0;
    std::deque<Ld06Turn> complete_;
    std::uint64_t count_ = 0;
    std::uint64_t parts_ = 0;
    std::uint64_t gaps_ = 0;
    std::uint64_t too_long_ = 0;
};

} // namespace scanloom::robot
