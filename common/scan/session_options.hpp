#pragma once

#include <optional>

namespace scanloom {

/// How a session is asked to turn scans into maps; what is absent takes the default.
/// Ranges and defaults: server/mapping/map_config.hpp, which checks them.
struct SessionOptions {
    std::optional<double> cell_size;          ///< metres
    std::optional<double> p_occupied;         ///< probability
    std::optional<double> p_free;             ///< probability
    std::optional<double> p_prior;            ///< probability
    std::optional<double> p_min;              ///< probability
    std::optional<double> p_max;              ///< probability
    std::optional<double> obstacle_thickness; ///< metres, alpha
    std::optional<double> beam_aperture;      ///< radians, beta

    friend bool operator==(const SessionOptions&, const SessionOptions&) = default;
};

} // namespace scanloom
