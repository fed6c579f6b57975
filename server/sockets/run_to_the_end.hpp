#pragma once

#include <boost/asio/io_context.hpp>

namespace scanloom::sockets {

/// Runs the context until it has no more work or is stopped. An exception from a handler is logged and ends only that
/// handler.
/// Threads: any number of threads may run one context.
void run_to_the_end(boost::asio::io_context& io) noexcept;

} // namespace scanloom::sockets
