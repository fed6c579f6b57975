#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace scanloom::session {

/// Memory budget shared by several maps, counted in pages of mapping::kPageBytes. A chunk is one page.
/// Threads: any thread.
class PageBudget {
public:
    explicit PageBudget(std::size_t pages_max)
        : pages_max_(static_cast<std::int64_t>(pages_max)), free_(static_cast<std::int64_t>(pages_max)) {}

    /// Takes `pages` (>= 0) if that many are free. @return whether they were taken; if not, none were
    [[nodiscard]] bool take(std::int64_t pages) noexcept {
        auto free = free_.load();
        while (pages <= free) {
            if (free_.compare_exchange_weak(free, free - pages)) return true;
        }
        return false;
    }

    /// Takes `pages` even if fewer are free, for maps that are in memory already. free() may become negative; take()
    /// then fails until enough pages are given back.
    void take_anyway(std::int64_t pages) noexcept { free_ -= pages; }

    void give_back(std::int64_t pages) noexcept { free_ += pages; }

    /// Returns the number of free pages; negative if take_anyway() exceeded the budget.
    [[nodiscard]] std::int64_t free() const noexcept { return free_; }
    [[nodiscard]] std::int64_t used() const noexcept { return pages_max_ - free_; }
    [[nodiscard]] std::int64_t pages_max() const noexcept { return pages_max_; }

private:
    const std::int64_t pages_max_;
    std::atomic<std::int64_t> free_;
};

} // namespace scanloom::session
