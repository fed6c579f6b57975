#pragma once

#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/awaitable.hpp>

namespace scanloom::robot {

/// Asks the server once all scans that were taken so far are in its maps: so the answer depends on the scans alone,
/// however long they were on their way. Cancelled, it abandons the question. The uplink outlives it.
/// Errors  kOverloaded: OpenRequests::kMax are open. A refusal of the server is in the reply.
[[nodiscard]] boost::asio::awaitable<Result<Reply>> ask_once_applied(Uplink& uplink, Request request);

} // namespace scanloom::robot
