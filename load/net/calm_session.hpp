#pragma once

#include "load/net/robot.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace scanloom::load {

/// A session into which one robot streams the course undisturbed, without faults. Its maps are what the maps of other
/// sessions should be.
class CalmSession {
public:
    /// The references must outlive this object; `io` must not run after its destruction.
    CalmSession(boost::asio::io_context& io, std::string name, const RunClock& clock, const Course& course,
                const RobotLinkOptions& link);
    ~CalmSession();

    /// Streams as fast as the server accepts scans, until this many are acknowledged.
    /// Pre: not fewer scans than before.
    /// Errors: the reason why the robot gave up; kTimeout: no scan was acknowledged for a minute.
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
