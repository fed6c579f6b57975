#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/prefer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <exception>
#include <type_traits>
#include <utility>

namespace scanloom::sockets {

/// Runs `work` on `executor`, then resumes on the coroutine's own executor with the result of `work`, or rethrows its
/// exception.
///
/// It waits in the queue of `executor` once; asio::co_spawn() would wait there a second time when the work is done.
/// @param work  its result is default-constructible and movable
template <class Work>
boost::asio::awaitable<std::invoke_result_t<Work&>> compute_on(boost::asio::any_io_executor executor, Work work) {
    namespace asio = boost::asio;
    using Made = std::invoke_result_t<Work&>;
    const asio::any_io_executor here = asio::prefer(asio::any_io_executor(co_await asio::this_coro::executor),
                                                    asio::execution::outstanding_work.tracked);
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>&, void(std::exception_ptr, Made)>(
        [&](auto handler) {
            asio::post(executor, [handler = std::move(handler), work = std::move(work), here]() mutable {
                std::exception_ptr failed;
                Made made{};
                try {
                    made = work();
                } catch (...) {
                    failed = std::current_exception();
                }
                asio::post(here, [handler = std::move(handler), failed, made = std::move(made)]() mutable {
                    std::move(handler)(failed, std::move(made));
                });
            });
        },
        asio::use_awaitable);
}

} // namespace scanloom::sockets
