#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::limits {

/// Memory that several users share, counted in pages.
/// Threads: any thread.
class MemoryBudget {
public:
    /// Creates a budget whose pages are all free.
    /// @param total  pages
    explicit MemoryBudget(std::size_t total)
        : total_(static_cast<std::int64_t>(total)), free_(static_cast<std::int64_t>(total)) {}

    /// Takes pages if that many are free.
    /// @param pages  0 or more
    /// @return whether the pages were taken; if not, none were
    [[nodiscard]] bool take(std::int64_t pages) noexcept {
        auto free = free_.load();
        while (pages <= free) {
            if (free_.compare_exchange_weak(free, free - pages)) return true;
        }
        return false;
    }

    /// Takes `pages` even if fewer are free, for data that are in memory already. free() may become negative; take()
    /// then fails until enough pages are given back.
    /// @param pages  0 or more
    void take_anyway(std::int64_t pages) noexcept { free_ -= pages; }

    /// Returns pages that were taken before.
    /// @param pages  at most as many as are taken
    void give_back(std::int64_t pages) noexcept { free_ += pages; }

    /// Returns the number of free pages; negative if take_anyway() exceeded the budget.
    [[nodiscard]] std::int64_t free() const noexcept { return free_; }
    /// Returns the number of taken pages; more than total() if take_anyway() exceeded the budget.
    [[nodiscard]] std::int64_t used() const noexcept { return total_ - free_; }
    /// Returns the size of the budget, in pages.
    [[nodiscard]] std::int64_t total() const noexcept { return total_; }

private:
    const std::int64_t total_;
    std::atomic<std::int64_t> free_;
};

/// The pages that one user has taken from several budgets, the same number from each. Gives them back in the
/// destructor.
/// Threads: one.
class MemoryShare {
public:
    /// Creates a share that has taken nothing yet.
    /// @param budgets  at least one; none is null
    explicit MemoryShare(std::vector<std::shared_ptr<MemoryBudget>> budgets) : budgets_(std::move(budgets)) {}
    MemoryShare(const MemoryShare&) = delete;
    MemoryShare& operator=(const MemoryShare&) = delete;
    ~MemoryShare() { give_back(taken_); }

    /// Takes `pages` (>= 0) from every budget, or from none if one of them has too few.
    /// @param pages  0 or more
    /// @return whether the pages were taken
    [[nodiscard]] bool take(std::int64_t pages) noexcept {
        if (pages == 0) return true; // even if the free count is negative
        for (auto budget = budgets_.begin(); budget != budgets_.end(); ++budget) {
            if ((*budget)->take(pages)) continue;
            while (budget != budgets_.begin()) (*--budget)->give_back(pages);
            return false;
        }
        taken_ += pages;
        return true;
    }

    /// Takes `pages` from every budget, even if fewer are free. See MemoryBudget::take_anyway().
    /// @param pages  0 or more
    void take_anyway(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->take_anyway(pages);
        taken_ += pages;
    }

    /// Returns pages to every budget.
    /// @param pages  at most as many as this share has taken
    void give_back(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->give_back(pages);
        taken_ -= pages;
    }

    /// Returns all pages that this share has taken.
    void give_back_all() noexcept { give_back(taken_); }

    /// Returns how many pages take() can take, at least 0. Other threads may change this at any time.
    [[nodiscard]] std::int64_t free() const noexcept {
        auto free = std::numeric_limits<std::int64_t>::max();
        for (const auto& budget : budgets_) free = std::min(free, budget->free());
        return std::max<std::int64_t>(0, free);
    }

    /// Returns the total size of the smallest budget, in pages.
    [[nodiscard]] std::int64_t most() const noexcept {
        auto most = std::numeric_limits<std::int64_t>::max();
        for (const auto& budget : budgets_) most = std::min(most, budget->total());
        return most;
    }

private:
    std::vector<std::shared_ptr<MemoryBudget>> budgets_;
    std::int64_t taken_ = 0;
};

} // namespace scanloom::limits
