#pragma once

#include <boost/asio/io_context.hpp>

namespace scanloom::sockets {

/// Runs the context's work until there is none or it is stopped. What a handler throws ends that handler only: it is
/// logged, and the others go on. Thread: any number of them may run one context.
void run_to_the_end(boost::asio::io_context& io) noexcept;

} // namespace scanloom::sockets
