#include "server/sockets/worker_pool.hpp"

#include <spdlog/spdlog.h>

#include <sys/resource.h>

#include <exception>

namespace scanloom::sockets {

void run_to_completion(boost::asio::io_context& io) noexcept {
    for (;;) {
        try {
            io.run();
            return;
        } catch (const std::exception& failure) {
            spdlog::error("a task failed: {}", failure.what());
        } catch (...) {
            spdlog::error("a task failed");
        }
    }
}

WorkerPool::WorkerPool(std::size_t threads, int niceness) : io_(static_cast<int>(threads)), work_(io_.get_executor()) {
    threads_.reserve(threads);
    try {
        while (threads_.size() < threads) {
            threads_.emplace_back([this, niceness] {
                if (niceness != 0) static_cast<void>(setpriority(PRIO_PROCESS, 0, niceness)); // of this thread alone
                run_to_completion(io_);
            });
        }
    } catch (...) {
        io_.stop();
        join();
        throw;
    }
}

WorkerPool::~WorkerPool() {
    io_.stop();
    join();
}

void WorkerPool::join() {
    work_.reset();
    for (auto& thread : threads_) thread.join();
    threads_.clear();
}

} // namespace scanloom::sockets
