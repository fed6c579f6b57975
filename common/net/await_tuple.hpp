#pragma once

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace scanloom {

/// Completion token: `co_await` returns the handler's arguments as a tuple, the error code first, instead of throwing.
inline constexpr auto kAwaitTuple = boost::asio::as_tuple(boost::asio::use_awaitable);

} // namespace scanloom
