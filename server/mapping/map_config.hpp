#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include <numbers>
#include <optional>
#include <span>

namespace scanloom::mapping {

/// How a session turns scans into maps. Checked: made by resolve() only from values in range.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 9.2; defaults of the design models.
struct MapConfig {
    double cell_size = 0.05;                         ///< metres, 0.01..1.0
    double p_occupied = 0.9;                         ///< probability in the band around a hit, 0.5..1 exclusive
    double p_free = 0.1;                             ///< probability before a hit, 0..0.5 exclusive
    double p_prior = 0.5;                            ///< probability of an unseen cell
    double p_min = 0.001;                            ///< clamp; below p_free and p_prior
    double p_max = 0.999;                            ///< clamp; above p_occupied and p_prior
    double obstacle_thickness = 0.1;                 ///< metres, alpha; at least one cell is used
    double beam_aperture = std::numbers::pi / 180.0; ///< radians, beta; at least the beam spacing is used

    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

/// One thing that can be set.
struct ConfigField {
    const char* name; ///< as people and programs write it
    std::optional<double> SessionOptions::*option;
    double MapConfig::*value;
};

/// The one list of what can be set.
[[nodiscard]] std::span<const ConfigField> config_fields() noexcept;

/// The options with defaults filled in.
/// Errors  kInvalidField: the message names the field, its value and its range.
[[nodiscard]] Result<MapConfig> resolve(const SessionOptions& options);

/// Every option set, as a session is stored.
[[nodiscard]] SessionOptions options_of(const MapConfig& config);

/// Errors  kConflict: an option that is set differs from the configuration in force.
[[nodiscard]] Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted);

} // namespace scanloom::mapping
