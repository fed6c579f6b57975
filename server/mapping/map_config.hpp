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

/// The settings that determine how a session turns scans into maps. Made by resolve(), which checks that all values are
/// in range.
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 9.2; Borenstein, Koren, HIMM (1991); Murphy,
///         Introduction to AI Robotics (2000), chapter 11; defaults of the design models.
struct MapConfig {
    double cell_size = 0.05; ///< metres, 0.01..1.0

    RayModel ray_model = RayModel::kInverseSensorModel;
    bool accumulate = false;         ///< bresenham, traversal: update a cell once per beam, not once per scan
    double hit_radius = 0.0;         ///< metres, 0..1; bresenham: cells within this distance of a hit are occupied
    bool drop_no_return = false;     ///< beams without a return show nothing; if false, they free their whole length
    double p_occupied = 0.9;         ///< probability in the band around a hit, 0.5..1 exclusive
    double p_free = 0.1;             ///< probability before a hit, 0..0.5 exclusive
    double p_prior = 0.5;            ///< probability of an unseen cell
    double p_min = 0.001;            ///< clamp; below p_free and p_prior
    double p_max = 0.999;            ///< clamp; above p_occupied and p_prior
    double obstacle_thickness = 0.1; ///< metres, alpha; at least one cell is used
    double beam_aperture = std::numbers::pi / 180.0; ///< radians, beta; at least the beam spacing is used

    std::int32_t himm_increment = 3;                      ///< added in the band around a hit
    std::int32_t himm_decrement = 1;                      ///< subtracted before a hit
    double himm_obstacle_thickness = 0.2;                 ///< metres; at least one cell is used
    double himm_beam_aperture = std::numbers::pi / 180.0; ///< radians; at least the beam spacing is used

    double sonar_obstacle_thickness = 0.5;               ///< metres; at least one cell is used
    double sonar_beam_aperture = std::numbers::pi / 6.0; ///< radians, for sensors that state no aperture
    double sonar_p_occupied_max = 0.98;                  ///< highest probability that one echo can give
    double sonar_p_min = 0.01;                           ///< clamp
    double sonar_p_max = 0.99;                           ///< clamp

    ClassSource class_source = ClassSource::kOccupancy;
    double class_p_occupied = 0.65;       ///< a cell is occupied at this probability or above
    double class_p_free = 0.35;           ///< a cell is free at this probability or below
    std::int32_t class_himm_occupied = 8; ///< a cell is occupied at this counter or above
    std::int32_t class_himm_free = 4;     ///< an occupied cell is free again at this counter or below
    std::int32_t danger_cells = 3;        ///< free cells within this distance of an occupied cell are in danger, 1..64
    double danger_radius = 0.0;           ///< metres, rounded up to cells; if greater than 0, replaces danger_cells

    double max_jump = 0.0; ///< metres; 0: off. See JumpFilter

    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

/// Returns the reach of the danger class in cells, from danger_radius or danger_cells.
[[nodiscard]] std::int32_t danger_reach(const MapConfig& config) noexcept;

/// The value of a setting in configuration files and APIs; an enumeration value is given by its name.
using ConfigValue = std::variant<bool, std::int32_t, double, std::string_view>;

/// One setting.
struct ConfigField {
    template <class Value>
    struct Member {
        std::optional<Value> SessionOptions::*option;
        Value MapConfig::*value;
    };

    const char* name; ///< name in configuration files and APIs
    std::variant<Member<bool>, Member<std::int32_t>, Member<double>, Member<RayModel>, Member<ClassSource>> member;
};

/// Returns all settings.
[[nodiscard]] std::span<const ConfigField> config_fields() noexcept;

/// Returns the setting with this name, or nullptr if there is none.
[[nodiscard]] const ConfigField* find_config_field(std::string_view name) noexcept;

/// Returns the value of a setting in `config`.
[[nodiscard]] ConfigValue value_of(const ConfigField& field, const MapConfig& config) noexcept;

/// Sets an option.
/// @param value  a value of the field's type; a whole number is accepted where the type is double
/// Errors: kInvalidField if the type or the enumeration name is wrong; the message names the field and the accepted
///         values.
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, const ConfigValue& value);

/// Sets an option from text, e.g. "0.05", "true", "bresenham".
/// Errors: kInvalidField if the text is not a value of the field's type; the message names the field and the accepted
///         values.
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, std::string_view text);

/// Fills in the defaults and checks all values.
/// Errors: kInvalidField if a value is out of range; the message names the field, its value and its range.
[[nodiscard]] Result<MapConfig> resolve(const SessionOptions& options);

/// Returns options with every field set, as they are stored with a session.
[[nodiscard]] SessionOptions options_of(const MapConfig& config);

/// Checks that the options of a request match the configuration of a session.
/// Errors: kConflict if an option is set and differs from the configuration.
[[nodiscard]] Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted);

} // namespace scanloom::mapping
