#include "server/sockets/accept_each.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>

namespace scanloom::sockets {
namespace asio = boost::asio;

asio::awaitable<void> accept_each(asio::ip::tcp::acceptor& acceptor, asio::io_context& io, std::string_view what,
                                  std::function<void(asio::ip::tcp::socket)> take) {
    asio::steady_timer pause(acceptor.get_executor());
    bool failed = false;
    while (acceptor.is_open()) {
        try {
            if (failed) {
                failed = false;
                pause.expires_after(std::chrono::milliseconds(100));
                co_await pause.async_wait(kAwaitTuple);
            }
            auto [error, socket] = co_await acceptor.async_accept(asio::make_strand(io), kAwaitTuple);
            if (!acceptor.is_open()) break;
            if (error) throw boost::system::system_error(error);
            take(std::move(socket));
        } catch (const std::exception& failure) {
            failed = true;
            spdlog::warn("{} could not be accepted: {}", what, failure.what());
        }
    }
}

} // namespace scanloom::sockets
