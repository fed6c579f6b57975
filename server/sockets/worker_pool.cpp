#include "server/sockets/worker_pool.hpp"

#include "server/sockets/run_to_the_end.hpp"

namespace scanloom::sockets {

WorkerPool::WorkerPool(std::size_t threads) : io_(static_cast<int>(threads)), work_(io_.get_executor()) {
    threads_.reserve(threads);
    try {
        while (threads_.size() < threads) threads_.emplace_back([this] { run_to_the_end(io_); });
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
