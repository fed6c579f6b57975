#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <cstddef>
#include <thread>
#include <vector>

namespace scanloom::sockets {

/// Threads that run what is posted to their executor. An exception ends the task that throws it and is logged;
/// boost::asio::thread_pool ends the process.
class WorkerPool {
public:
    using executor_type = boost::asio::io_context::executor_type;

    /// Throws std::system_error if the system has no more threads.
    explicit WorkerPool(std::size_t threads);

    /// Drops what has not begun, and waits for what has.
    ~WorkerPool();

    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    [[nodiscard]] executor_type get_executor() noexcept { return io_.get_executor(); }

    /// Waits until everything that was posted is done. Not from one of its threads.
    void join();

private:
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<executor_type> work_;
    std::vector<std::thread> threads_;
};

} // namespace scanloom::sockets
