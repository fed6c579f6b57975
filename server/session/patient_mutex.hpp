#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace scanloom::session {

/// A mutex with a timed lock, for std::unique_lock with a duration. Replaces std::timed_mutex, whose timed wait
/// ThreadSanitizer of GCC 12 does not support.
/// Threads: any thread.
class PatientMutex {
public:
    /// Waits up to `patience` for the mutex. @return whether the caller holds it
    [[nodiscard]] bool try_lock_for(std::chrono::milliseconds patience) {
        std::unique_lock lock(mutex_);
        if (!is_free_again_.wait_for(lock, patience, [&] { return !is_taken_; })) return false;
        is_taken_ = true;
        return true;
    }

    /// Releases the mutex, which the caller must hold.
    void unlock() {
        {
            const std::lock_guard lock(mutex_);
            is_taken_ = false;
        }
        is_free_again_.notify_one();
    }

private:
    std::mutex mutex_;
    std::condition_variable is_free_again_;
    bool is_taken_ = false;
};

} // namespace scanloom::session
