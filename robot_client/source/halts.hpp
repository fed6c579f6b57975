#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/located.hpp"
#include "robot_client/source/seen_points.hpp"
#include "robot_client/source/source.hpp"
#include "robot_client/source/stillness.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Divides the turns of a laser that is carried from place to place into halts, and says of each what is to be asked
/// and what becomes of its turns. Nothing is given whose place was not told.
///
/// A halt begins with kTurnsAlike turns in a row that are alike (Stillness). It ends with the first turn that is not,
/// and the kTurnsHeldBack turns before that one are not given either: there the movement may have begun. Turns in which
/// too little is seen to tell are dropped and change nothing. A room that changes by and by, until more of it is new
/// than a move would change, ends a halt, too; it is asked about again then.
///
/// Frames  the turns' poses are in an odometry frame of their own; a bare lidar stands at its origin.
/// Thread  one at a time. It has no clock: time is that of the turns' stamps.
class Halts {
public:
    static constexpr std::size_t kTurnsAlike = Stillness::kTurnsMax;
    static constexpr std::size_t kTurnsHeldBack = 3;
    static constexpr double kAskAgainAfter = 10.0; ///< seconds; others may have mapped the place meanwhile

    /// @param first_place  T_map_robot of the first halt, in case nothing is mapped then
    explicit Halts(const Pose2& first_place) : first_place_(first_place) {}

    /// The next turn. Pre  a laser took it; question() is answered.
    void add(Observation turn);

    /// What is to be asked now.
    [[nodiscard]] std::optional<SeenPoints> question() const;

    /// What the answer to question() was. Turns that were refused a place are dropped; newer ones are asked about
    /// kAskAgainAfter later, or at another place.
    void answer(const Result<Located>& located);

    /// There will be no more turns: those that stood still to the end are given.
    void end();

    /// The next turn to give, with its pose in the map.
    [[nodiscard]] std::optional<Observation> take();

    /// Sentences for people that are new; each is told once a halt, or again after many others.
    [[nodiscard]] std::vector<std::string> take_news();

    [[nodiscard]] bool is_located() const noexcept { return T_map_odom_.has_value(); }
    [[nodiscard]] std::uint64_t given() const noexcept { return given_; }
    /// Halts that ended because the sensor was moved.
    [[nodiscard]] std::uint64_t carried() const noexcept { return carried_; }
    /// Turns of which no place was known, and those that a movement may have begun in.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
    /// The newest refusal.
    [[nodiscard]] const std::optional<Error>& refusal() const noexcept { return refusal_; }

private:
    static constexpr std::size_t kToldMax = 32; // a refused halt may last for days

    void leave();
    void drop_held();
    void release(std::size_t held_back);
    void place_first();
    void refuse(Error refusal);
    void tell(std::string sentence);

    std::optional<Pose2> first_place_; ///< until it is used
    Stillness stillness_;
    std::deque<Observation> held_; ///< at most kTurnsAlike of the newest turns, all alike
    std::deque<Observation> ready_;
    std::optional<Pose2> T_map_odom_;  ///< of this halt
    bool begins_map_ = false;          ///< this halt: its place was said, not told
    std::optional<double> refused_at_; ///< stamp, seconds: of this halt
    std::optional<Error> refusal_;
    std::deque<std::string> told_; ///< of this halt, the newest kToldMax
    std::vector<std::string> news_;
    std::uint64_t given_ = 0;
    std::uint64_t carried_ = 0;
    std::uint64_t dropped_ = 0;
};

} // namespace scanloom::robot
