#pragma once

#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::lab::cluster {

/// Robots on each of several machines, and how the most and the fewest of them change with time. A robot counts on a
/// node from the moment when the node owns its session.
class Loads {
public:
    /// @param machines  at least one
    /// @param most      robots that a machine can serve; more are an overload
    /// @param from      figures begin at this time; before it robots only get their places
    Loads(std::size_t machines, double most, Time from);

    /// Changes the robots of a machine.
    /// Pre: `now` is not before that of the last call.
    void add(std::size_t machine, std::int64_t robots, Time now);

    /// Ends the figures.
    /// Pre: as add(). Call it once, last.
    void finish(Time now);

    [[nodiscard]] std::span<const std::int64_t> robots() const noexcept { return robots_; }

    [[nodiscard]] std::int64_t fullest() const; ///< robots of the fullest machine now
    [[nodiscard]] std::int64_t fullest_ever() const noexcept { return fullest_ever_; } ///< robots
    [[nodiscard]] double fullest_mean() const noexcept; ///< robots of the fullest machine, mean over the time

    /// Overloads, over all machines.
    struct Overload {
        std::size_t machines = 0; ///< that had one
        Time total{0};            ///< of all machines together
        Time longest{0};          ///< of one machine without a pause
    };
    [[nodiscard]] const Overload& overload() const noexcept { return overload_; }

private:
    struct Machine {
        Time since{0}; ///< begin of its overload
        bool is_over = false;
        bool was_over = false;
    };

    void advance(Time now);
    void end_overload(Machine& machine, Time now);

    std::vector<std::int64_t> robots_;
    std::vector<Machine> machines_;
    double most_;
    Time from_;
    Time now_{0};
    std::int64_t fullest_ever_ = 0;
    double robot_seconds_ = 0.0; ///< of the fullest machine
    Overload overload_;
};

} // namespace scanloom::lab::cluster
