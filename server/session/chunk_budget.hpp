#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace scanloom::session {

/// The chunks that all weaves under way may have together.
/// Thread  any.
class ChunkBudget {
public:
    explicit ChunkBudget(std::size_t chunks_max) : free_(static_cast<std::int64_t>(chunks_max)) {}

    /// All or none. Pre: chunks >= 0.
    [[nodiscard]] bool take(std::int64_t chunks) noexcept {
        auto free = free_.load();
        while (chunks <= free) {
            if (free_.compare_exchange_weak(free, free - chunks)) return true;
        }
        return false;
    }
    void give_back(std::int64_t chunks) noexcept { free_ += chunks; }

private:
    std::atomic<std::int64_t> free_;
};

} // namespace scanloom::session
