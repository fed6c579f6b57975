#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace scanloom::session {

/// A mutex that is waited for no longer than one may: std::timed_mutex, but seen by ThreadSanitizer, which in GCC 12
/// knows nothing of that one's waiting. For std::unique_lock with a duration.
/// Thread  any.
class PatientMutex {
public:
    /// Whether it is had now.
    [[nodiscard]] bool try_lock_for(std::chrono::milliseconds patience) {
        std::unique_lock lock(mutex_);
        if (!is_free_again_.wait_for(lock, patience, [&] { return !is_taken_; })) return false;
        is_taken_ = true;
        return true;
    }

    /// Pre  the caller has it.
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
