#pragma once

#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/awaitable.hpp>

namespace scanloom::robot {

/// Sends a request once all scans taken so far are in the server's maps, and returns the reply, which may be a refusal.
/// So the reply depends only on the scans, not on how long their transmission took. Abandons the request if cancelled.
/// `uplink` must outlive the coroutine.
/// Errors: kOverloaded if link::OpenRequests::kMax requests are open.
[[nodiscard]] boost::asio::awaitable<Result<link::Reply>> ask_once_applied(Uplink& uplink, link::Request request);

} // namespace scanloom::robot
