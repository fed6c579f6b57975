#pragma once

#include "server/session/page_budget.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::session {

/// What one map has taken of the budgets that it shares with others, the same of each; given back when this goes.
/// Thread  one.
class PageShare {
public:
    explicit PageShare(std::vector<std::shared_ptr<PageBudget>> budgets) : budgets_(std::move(budgets)) {}
    PageShare(const PageShare&) = delete;
    PageShare& operator=(const PageShare&) = delete;
    ~PageShare() { give_back(taken_); }

    /// Of every budget, or of none. Pre: pages >= 0.
    [[nodiscard]] bool take(std::int64_t pages) noexcept {
        if (pages == 0) return true; // however much was taken anyway
        for (auto budget = budgets_.begin(); budget != budgets_.end(); ++budget) {
            if ((*budget)->take(pages)) continue;
            while (budget != budgets_.begin()) (*--budget)->give_back(pages);
            return false;
        }
        taken_ += pages;
        return true;
    }

    void take_anyway(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->take_anyway(pages);
        taken_ += pages;
    }

    void give_back(std::int64_t pages) noexcept {
        for (const auto& budget : budgets_) budget->give_back(pages);
        taken_ -= pages;
    }

    void give_back_all() noexcept { give_back(taken_); }

    /// What can be taken at this moment, for all that others do meanwhile.
    [[nodiscard]] std::int64_t free() const noexcept {
        auto free = std::numeric_limits<std::int64_t>::max();
        for (const auto& budget : budgets_) free = std::min(free, budget->free());
        return std::max<std::int64_t>(0, free);
    }

    /// What there is of the smallest budget in all.
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
