#include "server/http/context.hpp"

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace scanloom::http {

namespace asio = boost::asio;

asio::awaitable<void> Context::run_on(Pool next) {
    if (next == pool) co_return;
    pool = next;
    if (next == Pool::kIo) {
        co_await asio::post(asio::use_awaitable);
    } else {
        co_await asio::post(asio::bind_executor(services.pools.executor_of(next), asio::use_awaitable));
    }
}

} // namespace scanloom::http
