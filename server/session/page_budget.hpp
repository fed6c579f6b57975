#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace scanloom::session {

/// The pages (mapping::kPageBytes) that some maps may take together. A chunk is a page.
/// Thread  any.
class PageBudget {
public:
    explicit PageBudget(std::size_t pages_max)
        : pages_max_(static_cast<std::int64_t>(pages_max)), free_(static_cast<std::int64_t>(pages_max)) {}

    /// All or none. Pre: pages >= 0.
    [[nodiscard]] bool take(std::int64_t pages) noexcept {
        auto free = free_.load();
        while (pages <= free) {
            if (free_.compare_exchange_weak(free, free - pages)) return true;
        }
        return false;
    }

    /// Also where there are not as many: of what is there already. Nothing can be taken until it is made up for.
    void take_anyway(std::int64_t pages) noexcept { free_ -= pages; }

    void give_back(std::int64_t pages) noexcept { free_ += pages; }

    /// Less than nothing where more was taken anyway.
    [[nodiscard]] std::int64_t free() const noexcept { return free_; }
    [[nodiscard]] std::int64_t used() const noexcept { return pages_max_ - free_; }
    [[nodiscard]] std::int64_t pages_max() const noexcept { return pages_max_; }

private:
    const std::int64_t pages_max_;
    std::atomic<std::int64_t> free_;
};

} // namespace scanloom::session
