#pragma once

#include "server/store/postgres_connection.hpp"

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

namespace scanloom::store::postgres {

/// Deletes the rows of removed sessions in the background, some at a time, so that appends hardly wait for it.
/// Threads: any.
class Sweeper {
public:
    /// Begins with what earlier servers left.
    explicit Sweeper(Place place);

    Sweeper(const Sweeper&) = delete;
    Sweeper& operator=(const Sweeper&) = delete;

    /// Tells that a session was removed.
    void wake();

private:
    void run(const std::stop_token& stop);
    void sweep(const std::stop_token& stop);

    const Place place_;
    std::mutex mutex_; // guards the member below
    bool is_awake_ = true;
    std::condition_variable_any waiting_;
    std::jthread thread_; // last: starts after everything that it uses
};

} // namespace scanloom::store::postgres
