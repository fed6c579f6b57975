#pragma once

#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/log_odds.hpp"
#include "server/mapping/map_config.hpp"

#include <algorithm>
#include <span>

namespace scanloom::mapping {

/// Adds evidence to log-odds: l = clamp(l + model(cell) - l0, l_min, l_max), unseen cells starting from the prior l0.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.1.
class OccupancyRule {
public:
    explicit OccupancyRule(const MapConfig& config) noexcept
        : prior_(to_fixed(log_odds_of(config.p_prior))), l_min_(to_fixed(log_odds_of(config.p_min))),
          l_max_(to_fixed(log_odds_of(config.p_max))), occupied_(to_fixed(log_odds_of(config.p_occupied)) - prior_),
          free_(to_fixed(log_odds_of(config.p_free)) - prior_) {}

    void apply(std::span<LogOdds> cells, Verdict verdict) const noexcept {
        const int step = verdict == Verdict::kOccupied ? occupied_ : free_;
        for (LogOdds& cell : cells) {
            const int before = cell == kUnknownLogOdds ? prior_ : cell;
            cell = static_cast<LogOdds>(std::clamp<int>(before + step, l_min_, l_max_));
        }
    }

    /// What a cell can hold at most and at least.
    [[nodiscard]] LogOdds certain(Verdict verdict) const noexcept {
        return verdict == Verdict::kOccupied ? l_max_ : l_min_;
    }

private:
    LogOdds prior_;
    LogOdds l_min_;
    LogOdds l_max_;
    int occupied_; // may exceed what a cell can hold: from one end of the clamp to the other
    int free_;
};

} // namespace scanloom::mapping
