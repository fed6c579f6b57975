#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/seen_points.hpp"
#include "robot_client/sources/source.hpp"
#include "robot_client/sources/stationary_detector.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Divides the turns of a laser that is carried from place to place into phases, in which the sensor is stationary.
/// Decides for each phase what to ask the server and which of its turns to send. Turns without a known pose are never
/// sent.
///
/// A phase begins with kTurnsAlike similar turns in a row (StationaryDetector). It ends with the first turn that
/// differs; the kTurnsHeldBack turns before that one are dropped too, because the movement may have begun in them.
/// Turns that show too little to decide are dropped and change nothing. A phase also ends when a room changes gradually
/// until more of it is new than a movement would change; the pose is then requested again.
///
/// Frames: the turns' poses are in an odometry frame of their own; a bare lidar is at its origin.
/// Threads: one at a time. The class has no clock: time is that of the turns' stamps.
class StationaryPhases {
public:
    static constexpr std::size_t kTurnsAlike = StationaryDetector::kTurnsMax;
    static constexpr std::size_t kTurnsHeldBack = 3;
    static constexpr double kRetryAfter = 10.0; ///< seconds; other robots may have mapped the place meanwhile

    /// @param first_place  T_map_robot of the first phase, used if no map exists then
    explicit StationaryPhases(const Pose2& first_place) : first_place_(first_place) {}

    /// Adds the next turn. Pre: a laser took it; it has a pose; question() is answered.
    void add(Observation turn);

    /// Returns the points to send in a locate request now, or nullopt if none is needed.
    [[nodiscard]] std::optional<SeenPoints> question() const;

    /// Takes the reply to question(). After a refusal the turns are dropped; the request is repeated for newer turns
    /// kRetryAfter later, or at another place.
    void answer(const Result<LocateResult>& located);

    /// Ends the sequence: the turns of a phase that lasted to the end are given.
    void end();

    /// Returns the next turn to send, with its pose in the map.
    [[nodiscard]] std::optional<Observation> take();

    /// Returns new messages for people. Each is given once per phase, or again after many others.
    [[nodiscard]] std::vector<std::string> take_messages();

    [[nodiscard]] std::uint64_t given() const noexcept { return given_; }
    /// Returns the number of phases that ended because the sensor was moved.
    [[nodiscard]] std::uint64_t carried() const noexcept { return carried_; }
    /// Returns the number of turns dropped because their pose was unknown or a movement may have begun in them.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
    /// Returns the newest refusal.
    [[nodiscard]] const std::optional<Error>& refusal() const noexcept { return refusal_; }

private:
    static constexpr std::size_t kReportedMax = 32; // a phase with a refused place may last for days

    void leave();
    void drop_held();
    void release(std::size_t held_back);
    void place_first();
    void refuse(Error refusal);
    void report(std::string sentence);

    std::optional<Pose2> first_place_; ///< until it is used
    StationaryDetector detector_;
    std::deque<Observation> held_; ///< at most kTurnsAlike of the newest turns, all alike
    std::deque<Observation> ready_;
    std::optional<Pose2> T_map_odom_;  ///< of this phase
    bool begins_map_ = false;          ///< whether the place of this phase was given by the user, not by the server
    std::optional<double> refused_at_; ///< stamp, seconds; of this phase
    std::optional<Error> refusal_;
    std::deque<std::string> reported_; ///< messages of this phase, the newest kReportedMax
    std::vector<std::string> messages_;
    std::uint64_t given_ = 0;
    std::uint64_t carried_ = 0;
    std::uint64_t dropped_ = 0;
};

} // namespace scanloom::robot
