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
    double stamp = 0.0;          ///< of its middle: one pose is meant for all its beams
    std::vector<Ld06Beam> beams; ///< 1 or more, their steps rising

    friend bool operator==(const Ld06Turn&, const Ld06Turn&) = default;
};

/// Cuts packets into turns, exactly where the angle crosses 0, within packets, too. A turn has as many points as it
/// has, and no direction twice: a point that is not ahead of the one before it is dropped.
///
/// The turn that is under way when the stream begins is dropped, and the one that is when it ends. A turn of which
/// packets were lost has a hole there. Where a whole turn may be missing, or angle and time disagree (something else
/// goes on), there is a gap: the turn ends with the points it has, and the points behind begin another one. These are
/// parts of turns, not full ones, and are given all the same: what was measured once is not to be had again.
class Ld06Turns {
public:
    /// `stamp`: of this packet, seconds.
    void add(const Ld06Packet& packet, double stamp);

    /// The next turn that is complete.
    [[nodiscard]] std::optional<Ld06Turn> next();

    /// The stream begins anew.
    void restart();

    /// Turns given to this day, parts among them, without those of more than kBeamsMax points.
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    /// Of these the ones that a gap has cut.
    [[nodiscard]] std::uint64_t parts() const noexcept { return parts_; }
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }
    /// Turns of more than kBeamsMax points, which are dropped: the sensor turns far too slowly.
    [[nodiscard]] std::uint64_t too_long() const noexcept { return too_long_; }

private:
    struct Before {
        std::int32_t start = 0; ///< steps within the turn under way
        std::uint16_t timestamp = 0;
    };

    [[nodiscard]] std::optional<std::int32_t> follow(const Ld06Packet& packet) const;
    void add_point(Ld06Beam beam, double stamp);
    void end_turn();

    std::optional<Before> before_; ///< the packet before
    bool is_given_ = false;        ///< the turn under way: its begin was seen, or is behind a gap
    bool is_part_ = false;         ///< so is this: a gap has cut it
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
