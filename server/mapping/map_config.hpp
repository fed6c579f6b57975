#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace scanloom::mapping {

/// How a session turns scans into maps. Checked: made by resolve() only from values in range.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 9.2; Borenstein, Koren, HIMM (1991);
///         Murphy, Introduction to AI Robotics (2000), chapter 11; defaults of the design models.
struct MapConfig {
    double cell_size = 0.05; ///< metres, 0.01..1.0

    RayModel ray_model = RayModel::kInverseSensorModel;
    bool accumulate = false;         ///< bresenham, traversal: a cell changes once a beam instead of once a scan
    double hit_radius = 0.0;         ///< metres, 0..1; bresenham: cells as near as this to a hit are occupied too
    bool drop_no_return = false;     ///< beams without a return show nothing, instead of freeing their whole length
    double p_occupied = 0.9;         ///< probability in the band around a hit, 0.5..1 exclusive
    double p_free = 0.1;             ///< probability before a hit, 0..0.5 exclusive
    double p_prior = 0.5;            ///< probability of an unseen cell
    double p_min = 0.001;            ///< clamp; below p_free and p_prior
    double p_max = 0.999;            ///< clamp; above p_occupied and p_prior
    double obstacle_thickness = 0.1; ///< metres, alpha; at least one cell is used
    double beam_aperture = std::numbers::pi / 180.0; ///< radians, beta; at least the beam spacing is used

    std::int32_t himm_increment = 3;                      ///< added in the band around a hit
    std::int32_t himm_decrement = 1;                      ///< taken off before a hit
    double himm_obstacle_thickness = 0.2;                 ///< metres; at least one cell is used
    double himm_beam_aperture = std::numbers::pi / 180.0; ///< radians; at least the beam spacing is used

    double sonar_obstacle_thickness = 0.5;               ///< metres; at least one cell is used
    double sonar_beam_aperture = std::numbers::pi / 6.0; ///< radians, of sensors that state none
    double sonar_p_occupied_max = 0.98;                  ///< the most that one echo says
    double sonar_p_min = 0.01;                           ///< clamp
    double sonar_p_max = 0.99;                           ///< clamp

    ClassSource class_source = ClassSource::kOccupancy;
    double class_p_occupied = 0.65;       ///< from this probability a cell is occupied
    double class_p_free = 0.35;           ///< down from this one it is free
    std::int32_t class_himm_occupied = 8; ///< from this counter a cell is occupied
    std::int32_t class_himm_free = 4;     ///< down from this one it is free again
    std::int32_t danger_cells = 3;        ///< free cells as near as this to an occupied one are in danger, 1..64
    double danger_radius = 0.0;           ///< metres, rounded up to cells; more than 0: in place of danger_cells

    double max_jump = 0.0; ///< metres; 0: off. See JumpFilter

    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

/// Cells, whichever way it was given.
[[nodiscard]] std::int32_t danger_reach(const MapConfig& config) noexcept;

/// The value of a setting as people and programs write it: an enumeration by its name.
using ConfigValue = std::variant<bool, std::int32_t, double, std::string_view>;

/// One thing that can be set.
struct ConfigField {
    template <class Value>
    struct Member {
        std::optional<Value> SessionOptions::*option;
        Value MapConfig::*value;
    };

    const char* name; ///< as people and programs write it
    std::variant<Member<bool>, Member<std::int32_t>, Member<double>, Member<RayModel>, Member<ClassSource>> member;
};

/// The one list of what can be set.
[[nodiscard]] std::span<const ConfigField> config_fields() noexcept;

/// Nothing where there is no such field.
[[nodiscard]] const ConfigField* find_config_field(std::string_view name) noexcept;

[[nodiscard]] ConfigValue value_of(const ConfigField& field, const MapConfig& config) noexcept;

/// Takes a value of the field's own kind, and a whole number where any number may stand.
/// Errors  kInvalidField: the message names the field and what it may be.
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, const ConfigValue& value);

/// The same from text: "0.05", "true", "bresenham".
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, std::string_view text);

/// The options with defaults filled in.
/// Errors  kInvalidField: the message names the field, its value and its range.
[[nodiscard]] Result<MapConfig> resolve(const SessionOptions& options);

/// Every option set, as a session is stored.
[[nodiscard]] SessionOptions options_of(const MapConfig& config);

/// Errors  kConflict: an option that is set differs from the configuration in force.
[[nodiscard]] Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted);

} // namespace scanloom::mapping
