#pragma once

#include "load/net/shard.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// Spreads robots over sessions: robot i joins session i % sessions. The robots of a session start evenly spaced on the
/// course, so that sessions with equally many robots receive the same scans.
[[nodiscard]] std::vector<RobotPlan> spread_over(const std::vector<std::string>& sessions, std::uint32_t robots,
                                                 std::size_t course_scans);

/// All robots, on as many threads as planned.
/// Threads: one at a time.
class Fleet {
public:
    /// The references must outlive this object.
    Fleet(const FleetPlan& plan, const std::vector<RobotPlan>& robots, const RunClock& clock, const Course& course,
          const RobotLinkOptions& link);

    void connect();
    void begin(Micros start);
    void end();
    void stop();

    [[nodiscard]] std::unique_ptr<Shard::Look> look();
    [[nodiscard]] Shard::Progress progress();

    /// Returns the number of acknowledged scans of each robot.
    /// Pre: stop() was called.
    [[nodiscard]] std::vector<std::uint64_t> acknowledged() const;

private:
    std::vector<std::unique_ptr<Shard>> shards_;
};

} // namespace scanloom::load
