#pragma once

#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/lidars/lidar_turn.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace scanloom::robot {

/// Collects the points of a lidar that marks where its turns begin and states no time. Points may be out of order by
/// some degrees, because sensors correct their angles by the distance: each turn is sorted. Of several points in one
/// direction, the first is used.
///
/// The incomplete turns at the beginning and at the end of the stream are dropped. A turn with lost points has a hole
/// there. Points that go round further than one turn, because a mark was lost, are dropped: they were taken from
/// different places.
class MarkedTurns {
public:
    /// @param steps_per_turn  of the beams
    explicit MarkedTurns(std::int32_t steps_per_turn) : steps_per_turn_(steps_per_turn) {}

    /// Ends the current turn; the next point is the first one of another.
    /// @param arrival  Unix seconds, of the mark
    void begin_turn(double arrival);

    /// @param beam  its step is from 0 to steps_per_turn - 1
    void add(const LidarBeam& beam);

    /// Returns the next complete turn. Its duration is known from the second turn on.
    [[nodiscard]] std::optional<LidarTurn> next();

    /// Starts a new stream.
    void restart();

    /// Returns the number of turns given.
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    /// Returns the number of lost marks.
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }
    /// Returns the number of turns with more than kBeamsMax points, which are dropped.
    [[nodiscard]] std::uint64_t too_long() const noexcept { return too_long_; }

private:
    void end_turn();

    std::int32_t steps_per_turn_;
    TurnClock clock_;
    bool is_given_ = false; ///< the current turn began with a mark
    std::vector<LidarBeam> beams_;
    std::optional<std::int32_t> last_step_;
    std::int64_t travelled_ = 0; ///< steps from the first point of the turn to the newest
    std::deque<LidarTurn> complete_;
    std::uint64_t count_ = 0;
    std::uint64_t gaps_ = 0;
    std::uint64_t too_long_ = 0;
};

} // namespace scanloom::robot
