#pragma once

#include "tests/integration/ingest_fixture.hpp"

#include <boost/asio/post.hpp>

#include <algorithm>
#include <cstdint>
#include <future>
#include <memory>
#include <numbers>
#include <string>

namespace scanloom::ingest {

inline Sensor half_round_laser() {
    Sensor sensor;
    sensor.id = 1;
    sensor.name = "laser";
    sensor.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 180, 181};
    sensor.range_max = 20.0;
    return sensor;
}

/// A wall at a distance of three metres, and a sector without readings: frontiers are there and behind the robot.
inline Scan scan_with_a_gap(std::uint64_t seq = 1) {
    Scan scan;
    scan.seq = seq;
    scan.stamp = static_cast<double>(seq);
    scan.sensor = 1;
    scan.pose = {0.5, 1.25, 0.0};
    scan.ranges.assign(181, 3'000);
    std::fill(scan.ranges.begin() + 100, scan.ranges.begin() + 130, kInvalidRange);
    return scan;
}

/// Robots that have scanned a room, and requests that wait.
class RequestsTest : public IngestTest {
protected:
    /// A robot whose first scan has been applied.
    std::unique_ptr<RobotSocket> looking_around(const std::string& name, const std::string& session = "lab") {
        auto robot = welcomed(port(), hello(name, session));
        robot->send(half_round_laser());
        robot->send(wire::ScanBatch{{scan_with_a_gap()}});
        robot->wait_for_ack(1);
        return robot;
    }

    /// Blocks all searches until the returned promise is fulfilled.
    std::promise<void> hold_searches() {
        std::promise<void> go_on;
        boost::asio::post(running_->planning(), [wait = go_on.get_future().share()] { wait.wait(); });
        return go_on;
    }
};

inline wire::PlanRequest plan_to(const Point2& goal, std::uint64_t id = 1) { return {.id = id, .goal = goal}; }

} // namespace scanloom::ingest
