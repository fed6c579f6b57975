#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace scanloom::limits {

/// Limits how many uses of a resource may exist at once. It never waits: a caller that gets no permit refuses its
/// request.
/// Threads: any thread.
class Semaphore {
public:
    /// Released with the last copy. May outlive the semaphore.
    using Permit = std::shared_ptr<const void>;

    /// Creates a semaphore with this many permits.
    explicit Semaphore(std::size_t permits) : free_(std::make_shared<std::atomic<std::ptrdiff_t>>(permits)) {}

    /// Takes a permit.
    /// @return null if all permits are taken
    [[nodiscard]] Permit try_acquire() const {
        if (free_->fetch_sub(1) > 0) return {free_.get(), [free = free_](const void*) { free->fetch_add(1); }};
        free_->fetch_add(1);
        return nullptr;
    }

private:
    std::shared_ptr<std::atomic<std::ptrdiff_t>> free_;
};

} // namespace scanloom::limits
