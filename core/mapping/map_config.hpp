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
[[nodiscard]] std::int32_t danger_reach(const MapConfig& config) noexcept;

/// The value of a setting in configuration files and APIs; an enumeration value is given by its name.
using ConfigValue = std::variant<bool, std::int32_t, double, std::string_view>;

/// The range of a setting's values. A setting whose values have no order has no bounds.
struct Bounds {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_is_excluded = false;
    bool high_is_excluded = false;

    [[nodiscard]] bool contain(double value) const noexcept;
};

/// The description of one setting.
struct ConfigField {
    template <class Value>
    struct Member {
        std::optional<Value> SessionOptions::*option;
        Value MapConfig::*value;
    };

    const char* name; ///< name in configuration files and APIs
    std::variant<Member<bool>, Member<std::int32_t>, Member<double>, Member<RayModel>, Member<ClassSource>> member;
    const char* unit; ///< empty if it has none
    Bounds bounds;
    const char* help; ///< what it does, in sentences
};

/// Returns the names of the values of an enumeration, or an empty list for a setting of another type.
[[nodiscard]] std::span<const std::string_view> choices_of(const ConfigField& field) noexcept;

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
