#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace scanloom::mapping {

/// The settings that determine how a session turns scans into maps; common/scan/settings.def documents each. Made by
/// resolve(), which checks that all values are in range.
struct MapConfig {
#define SCANLOOM_SETTING(type, name, initial, ...) type name = initial;
#include "common/scan/settings.def"

    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

/// Returns the reach of the danger class in cells, from danger_radius or danger_cells.
/// @param config  danger_radius in metres, or danger_cells
[[nodiscard]] std::int32_t danger_reach(const MapConfig& config) noexcept;

/// The value of a setting in configuration files and APIs; an enumeration value is given by its name.
using ConfigValue = std::variant<bool, std::int32_t, double, std::string_view>;

/// The range of a setting's values. A setting whose values have no order has no bounds.
struct Bounds {
    double low = -std::numeric_limits<double>::infinity(); ///< smallest value
    double high = std::numeric_limits<double>::infinity(); ///< largest value
    bool low_is_excluded = false;                          ///< whether values must be greater than `low`
    bool high_is_excluded = false;                         ///< whether values must be less than `high`

    /// Returns whether a value is within the bounds; false for NaN.
    [[nodiscard]] bool contain(double value) const noexcept;
};

/// The description of one setting.
struct ConfigField {
    /// Where the requested value and the value in use are.
    template <class Value>
    struct Member {
        std::optional<Value> SessionOptions::*option; ///< absent: the default
        Value MapConfig::*value;                      ///< always set
    };

    const char* name; ///< name in configuration files and APIs
    std::variant<Member<bool>, Member<std::int32_t>, Member<double>, Member<RayModel>, Member<ClassSource>>
        member;       ///< by the type of its value
    const char* unit; ///< empty if it has none
    Bounds bounds;    ///< of the value, in `unit`
    const char* help; ///< what it does, in sentences
};

/// Returns the names of the values of an enumeration, or an empty list for a setting of another type.
/// @param field  a setting
[[nodiscard]] std::span<const std::string_view> choices_of(const ConfigField& field) noexcept;

/// Returns all settings.
[[nodiscard]] std::span<const ConfigField> config_fields() noexcept;

/// Returns the setting with this name, or nullptr if there is none.
/// @param name  as in ConfigField::name
[[nodiscard]] const ConfigField* find_config_field(std::string_view name) noexcept;

/// Returns the value of a setting in `config`.
/// @param field   the setting to read
/// @param config  settings of a session
[[nodiscard]] ConfigValue value_of(const ConfigField& field, const MapConfig& config) noexcept;

/// Sets an option.
/// @param options  changed
/// @param field    the setting to change
/// @param value    a value of the field's type; a whole number is accepted where the type is double
/// Errors: kInvalidField if the type or the enumeration name is wrong; the message names the field and the accepted
///         values.
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, const ConfigValue& value);

/// Sets an option from text, e.g. "0.05", "true", "bresenham".
/// @param options  changed
/// @param field    the setting to change
/// @param text     e.g. "0.05"
/// Errors: kInvalidField if the text is not a value of the field's type; the message names the field and the accepted
///         values.
[[nodiscard]] Result<> set_option(SessionOptions& options, const ConfigField& field, std::string_view text);

/// Fills in the defaults and checks all values.
/// @param options  values that were requested
/// Errors: kInvalidField if a value is out of range; the message names the field, its value and its range.
[[nodiscard]] Result<MapConfig> resolve(const SessionOptions& options);

/// Returns options with every field set, as they are stored with a session.
/// @param config  settings of a session
[[nodiscard]] SessionOptions options_of(const MapConfig& config);

/// Checks that the options of a request match the configuration of a session.
/// @param config  settings of the session
/// @param wanted  options of the request; absent ones agree with any value
/// Errors: kConflict if an option is set and differs from the configuration.
[[nodiscard]] Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted);

} // namespace scanloom::mapping
