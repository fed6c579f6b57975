#pragma once

#include "common/net/http_connection.hpp"
#include "load/core/verdict.hpp"
#include "load/net/robot.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// A session into which one robot streams the workload undisturbed, without faults. Its maps are what the maps of other
/// sessions should be.
class ReferenceSession {
public:
    /// The references must outlive this object; `io` must not run after its destruction.
    ReferenceSession(boost::asio::io_context& io, std::string name, const RunClock& clock, const Workload& workload,
                     const RobotLinkOptions& link);
    ~ReferenceSession();

    /// Streams as fast as the server accepts scans, until this many are acknowledged.
    /// Pre: not fewer scans than before.
    /// Errors: the reason why the robot gave up; kTimeout: no scan was acknowledged for a minute.
    [[nodiscard]] boost::asio::awaitable<Result<>> stream_to(std::uint64_t scans);

private:
    boost::asio::io_context& io_;
    const RunClock& clock_;
    Workload workload_;
    std::unique_ptr<FleetFigures> figures_ = std::make_unique<FleetFigures>();
    Troubles troubles_;
    Robot robot_;
};

/// Called from time to time with the progress: "12 of 40 sessions".
using ReportProgress = std::function<void(const std::string&)>;

/// Reads every session from the server, and adds the number of its scans and what contradicts the acknowledgements to
/// `evidence`.
[[nodiscard]] boost::asio::awaitable<void> verify_counts(net::HttpConnection& http,
                                                         const std::vector<ExpectedSession>& sessions,
                                                         ReportProgress report, Evidence& evidence);

/// Compares the maps of every session with those of `reference`, into which the same scans are streamed here: as many
/// as the session with the fewest has, then up to each next number that occurs. Pre: one robot per session.
[[nodiscard]] boost::asio::awaitable<void> verify_digests(net::HttpConnection& http,
                                                          std::vector<ExpectedSession> sessions,
                                                          std::string reference_name, ReferenceSession& reference,
                                                          ReportProgress report, Evidence& evidence);

} // namespace scanloom::load
