#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace scanloom::sockets {

/// How many of a kind there may be at once. Nobody waits for a slot: who gets none says so.
/// Thread  any.
class Slots {
public:
    explicit Slots(std::size_t count) : free_(std::make_shared<std::atomic<std::ptrdiff_t>>(count)) {}

    /// A slot, free again when its last copy is gone; null when all are taken.
    [[nodiscard]] std::shared_ptr<const void> try_take() const {
        if (free_->fetch_sub(1) > 0) return {free_.get(), [free = free_](const void*) { free->fetch_add(1); }};
        free_->fetch_add(1);
        return nullptr;
    }

private:
    std::shared_ptr<std::atomic<std::ptrdiff_t>> free_;
};

} // namespace scanloom::sockets
