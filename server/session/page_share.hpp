#pragma once

#include "server/session/page_budget.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::session {

/// The pages that one map has taken from several shared budgets, the same number from each. Gives them back in the
/// destructor.
/// Threads: one.
class PageShare {
public:
    explicit PageShare(std::vector<std::shared_ptr<PageBudget>> budgets) : budgets_(std::move(budgets)) {}
    PageShare(const PageShare&) = delete;
    PageShare& operator=(const PageShare&) = delete;
    ~PageShare() { give_back(taken_); }

    /// Takes `pages` (>= 0) from every budget, or from none if one of them has too few. @return whether they were taken
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

    /// Takes `pages` from every budget, even if fewer are free. See PageBudget::take_anyway().
    void take_anyway(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->take_anyway(pages);
        taken_ += pages;
    }

    void give_back(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->give_back(pages);
        taken_ -= pages;
    }

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
        for (const auto& budget : budgets_) most = std::min(most, budget->pages_max());
        return most;
    }

private:
    std::vector<std::shared_ptr<PageBudget>> budgets_;
    std::int64_t taken_ = 0;
};

} // namespace scanloom::session
