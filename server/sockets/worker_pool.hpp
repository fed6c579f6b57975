#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/prefer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <cstddef>
#include <exception>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace scanloom::sockets {

/// Runs the context until it has no more work or is stopped. An exception from a handler is logged and ends only that
/// handler.
/// Threads: any number of threads may run one context.
void run_to_completion(boost::asio::io_context& io) noexcept;

/// A pool of threads that run the tasks posted to its executor. An exception from a task is logged and ends only that
/// task; with boost::asio::thread_pool it would end the process.
class WorkerPool {
public:
    using executor_type = boost::asio::io_context::executor_type;

    /// Starts `threads` threads. Throws std::system_error if the system cannot create them.
    /// @param niceness  added to the process's; a higher one means less processor time, see setpriority(2)
    explicit WorkerPool(std::size_t threads, int niceness = 0);

    /// Drops tasks that have not started, and waits for running tasks.
    ~WorkerPool();

    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    [[nodiscard]] executor_type get_executor() noexcept { return io_.get_executor(); }

    /// Waits until all posted tasks are done, then ends the threads.
    /// Threads: not from a thread of this pool.
    void join();

private:
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<executor_type> work_;
    std::vector<std::thread> threads_;
};

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

/// Calls `start` with a callback, and resumes on the coroutine's own executor with the value that the callback
/// receives, on any thread.
template <class Value, class Start>
boost::asio::awaitable<Value> resume_with(const Start& start) {
    namespace asio = boost::asio;
    const auto executor = co_await asio::this_coro::executor;
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>&, void(Value)>(
        [&](auto handler) {
            auto shared = std::make_shared<decltype(handler)>(std::move(handler));
            start([shared, executor](const Value& value) {
                asio::post(executor, [shared, value] { std::move (*shared)(value); });
            });
        },
        asio::use_awaitable);
}

} // namespace scanloom::sockets
