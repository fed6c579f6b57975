#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace scanloom::sockets {

/// A semaphore without waiting: limits how many uses of a resource may exist at once. A caller that gets no slot
/// refuses its request.
/// Threads: any thread.
class Slots {
public:
    explicit Slots(std::size_t count) : free_(std::make_shared<std::atomic<std::ptrdiff_t>>(count)) {}

    /// Takes a slot, which is released with the last copy of the returned pointer.
    /// @return null if all slots are taken
    [[nodiscard]] std::shared_ptr<const void> try_take() const {
        if (free_->fetch_sub(1) > 0) return {free_.get(), [free = free_](const void*) { free->fetch_add(1); }};
        free_->fetch_add(1);
        return nullptr;
    }

private:
    std::shared_ptr<std::atomic<std::ptrdiff_t>> free_;
};

} // namespace scanloom::sockets
