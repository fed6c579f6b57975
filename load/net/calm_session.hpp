#pragma once

#include "load/net/robot.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace scanloom::load {

/// A session into which one robot streams the course in peace: nothing else happens, no link is cut. What the maps of
/// other sessions should be is read from its own.
class CalmSession {
public:
    /// The references stay until this is gone; `io` is not run after that.
    CalmSession(boost::asio::io_context& io, std::string name, const RunClock& clock, const Course& course,
                const RobotLinkOptions& link);
    ~CalmSession();

    /// Goes on until this many scans are acknowledged, as fast as the server takes them. Pre: not fewer than before.
    /// Errors  why the robot gave up; kTimeout: nothing was acknowledged for a minute.
    [[nodiscard]] boost::asio::awaitable<Result<>> stream_to(std::uint64_t scans);

private:
    boost::asio::io_context& io_;
    const RunClock& clock_;
    Course course_;
    std::unique_ptr<FleetFigures> figures_ = std::make_unique<FleetFigures>();
    Troubles troubles_;
    Robot robot_;
};

} // namespace scanloom::load
