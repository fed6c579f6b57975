#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <cstddef>
#include <thread>
#include <vector>

namespace scanloom::sockets {

/// A pool of threads that run the tasks posted to its executor. An exception from a task is logged and ends only that
/// task; with boost::asio::thread_pool it would end the process.
class WorkerPool {
public:
    using executor_type = boost::asio::io_context::executor_type;

    /// Starts `threads` threads. Throws std::system_error if the system cannot create them.
    explicit WorkerPool(std::size_t threads);

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

} // namespace scanloom::sockets
