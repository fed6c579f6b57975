#pragma once

#include "sim/drive/behaviour.hpp"
#include "sim/drive/ground.hpp"
#include "sim/drive/path_follower.hpp"

#include <optional>
#include <vector>

namespace scanloom::robot {

/// Returns the points of the newest scan that are not in the plan: more than 0.12 m from everything that stands still
/// there. Metres in the map frame.
[[nodiscard]] std::vector<Point2> unexpected_obstacles(const Ground& ground, const Senses& senses);

/// A detour around an unexpected obstacle on a line, in three parts: sideways, past the obstacle parallel to the line,
/// and back to the line as soon as it is free.
class Detour {
public:
    enum class State { kActive, kBackOnLine, kPastEnd, kFailed };

    /// Chooses the nearer side among those where the ground and the obstacles leave room.
    /// @param end  of the line that starts at the robot
    /// @return nullopt if neither side has room
    [[nodiscard]] static std::optional<Detour> plan(const Ground& ground, const Senses& senses, const Point2& end);

    [[nodiscard]] Velocity step(const Ground& ground, const Senses& senses);

    /// kPastEnd: the robot is next to the line's end and could not return to the line. kFailed: its detour has been
    /// blocked for some time.
    [[nodiscard]] State state() const noexcept { return state_; }

private:
    enum class Part { kAside, kPast, kBack };

    /// A frame whose x axis is the line.
    struct Line {
        Point2 begin;
        Point2 ahead;
        double length = 0.0; // metres
        [[nodiscard]] Point2 to_line(const Point2& point) const;
        [[nodiscard]] Point2 to_map(const Point2& point) const;
    };

    struct Seen {
        Point2 place; // in the line's frame
        int step;
    };

    Detour(const Line& line, double offset, double first_obstacle);
    static std::optional<double> side(const Ground& ground, const Line& line, const std::vector<Point2>& obstacles,
                                      double first);
    void remember(const Ground& ground, const Senses& senses);
    void begin_next_part(const Ground& ground, const Point2& position);
    [[nodiscard]] double free_length(const Ground& ground) const;
    [[nodiscard]] bool may_return(const Ground& ground, const Point2& on_line) const;

    Line line_;
    double offset_;         // metres to the left of the line
    double first_obstacle_; // metres along the line
    double room_ = 0.0;     // metres free parallel to the line
    Part part_ = Part::kAside;
    State state_ = State::kActive;
    PathFollower follower_;
    std::vector<Seen> seen_;
    int step_ = 0;
};

} // namespace scanloom::robot
