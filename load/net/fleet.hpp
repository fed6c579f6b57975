#pragma once

#include "load/net/shard.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// Robots that are spread over sessions, robot i in session i % sessions. Those of one session begin at places of the
/// course that are evenly apart, so that every session gets the same as any other with as many robots.
[[nodiscard]] std::vector<RobotPlan> spread_over(const std::vector<std::string>& sessions, std::uint32_t robots,
                                                 std::size_t course_scans);

/// All robots, on as many threads as planned. Thread  one at a time.
class Fleet {
public:
    /// The references stay until this is gone.
    Fleet(const FleetPlan& plan, const std::vector<RobotPlan>& robots, const RunClock& clock, const Course& course,
          const RobotLinkOptions& link);

    void connect();
    void begin(Micros start);
    void end();
    void stop();

    [[nodiscard]] std::unique_ptr<Shard::Look> look();
    [[nodiscard]] Shard::Progress progress();

    /// What was acknowledged to each robot. Pre  stop() was called.
    [[nodiscard]] std::vector<std::uint64_t> acknowledged() const;

private:
    std::vector<std::unique_ptr<Shard>> shards_;
};

} // namespace scanloom::load
