#pragma once

#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/map_config.hpp"

namespace scanloom::mapping {

/// The rule for adding evidence to log-odds: l = clamp(l + model(cell) - l0, l_min, l_max). Unseen cells start at the
/// prior l0.
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.1.
struct OccupancyRule {
    /// Converts the probabilities of a session's settings to fixed-point log-odds.
    explicit OccupancyRule(const MapConfig& config) noexcept
        : prior(to_fixed(log_odds_of(config.p_prior))), l_min(to_fixed(log_odds_of(config.p_min))),
          l_max(to_fixed(log_odds_of(config.p_max))), occupied(to_fixed(log_odds_of(config.p_occupied)) - prior),
          free(to_fixed(log_odds_of(config.p_free)) - prior) {}

    LogOdds prior; ///< l0
    LogOdds l_min; ///< lower end of the clamp
    LogOdds l_max; ///< upper end of the clamp
    int occupied;  ///< model(cell) - l0; may exceed the range of LogOdds: from one end of the clamp to the other
    int free;      ///< likewise
};

} // namespace scanloom::mapping
