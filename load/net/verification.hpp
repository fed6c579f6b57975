#pragma once

#include "load/core/verdict.hpp"
#include "load/net/calm_session.hpp"
#include "load/net/http_connection.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <string>
#include <vector>

namespace scanloom::load {

/// Called from time to time with the progress: "12 of 40 sessions".
using ReportProgress = std::function<void(const std::string&)>;

/// Reads every session from the server, and adds the number of its scans and what contradicts the acknowledgements to
/// `evidence`.
[[nodiscard]] boost::asio::awaitable<void> verify_counts(HttpConnection& http,
                                                         const std::vector<ExpectedSession>& sessions,
                                                         ReportProgress report, Evidence& evidence);

/// Compares the maps of every session with those of `calm`, into which the same scans are streamed here: as many as the
/// session with the fewest has, then up to each next number that occurs.
/// Pre: one robot per session.
[[nodiscard]] boost::asio::awaitable<void> verify_digests(HttpConnection& http, std::vector<ExpectedSession> sessions,
                                                          std::string calm_name, CalmSession& calm,
                                                          ReportProgress report, Evidence& evidence);

} // namespace scanloom::load
