#include "core/mapping/map_config.hpp"

#include "common/text/parse_number.hpp"
#include "core/classify/class_layer.hpp"
#include "core/mapping/laser_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

namespace scanloom::mapping {
namespace {

using O = SessionOptions;
using C = MapConfig;

constexpr Bounds kAny;
constexpr Bounds within(double low, double high) { return {low, high, false, false}; }
constexpr Bounds between(double low, double high) { return {low, high, true, true}; }
constexpr Bounds above(double low, double high) { return {low, high, true, false}; }
constexpr Bounds below(double low, double high) { return {low, high, false, true}; }

const std::array kFields = {
#define SCANLOOM_SETTING(type, name, initial, unit, bounds, help)                                                      \
    ConfigField{#name, ConfigField::Member<type>{&O::name, &C::name}, unit, bounds, help},
#include "common/scan/settings.def"
};

constexpr std::int32_t kDangerCellsMax = classify::ClassLayer::kDangerCellsMax;
static_assert(kDangerCellsMax == 64); // the bound in settings.def

/// The names of an enumeration's values, in the order of the values.
template <class Choice>
constexpr std::array<std::string_view, 0> kNames;
template <>
constexpr std::array<std::string_view, 3> kNames<RayModel> = {"inverse_sensor_model", "bresenham", "traversal"};
template <>
constexpr std::array<std::string_view, 2> kNames<ClassSource> = {"occupancy", "himm"};

Error unfit(const char* name, std::string_view what) {
    return {Errc::kInvalidField, fmt::format("{} must be {}", name, what)};
}

template <class Value>
Result<Value> as(const char* name, const ConfigValue& value) {
    if constexpr (std::is_enum_v<Value>) {
        if (const auto* text = std::get_if<std::string_view>(&value)) {
            const auto found = std::ranges::find(kNames<Value>, *text);
            if (found != kNames<Value>.end()) return static_cast<Value>(found - kNames<Value>.begin());
        }
        return unfit(name, fmt::format("one of {}", fmt::join(kNames<Value>, ", ")));
    } else {
        if (const auto* same = std::get_if<Value>(&value)) return *same;
        if constexpr (std::is_same_v<Value, bool>) return unfit(name, "true or false");
        if constexpr (std::is_same_v<Value, std::int32_t>) return unfit(name, "a whole number of at most 32 bits");
        if constexpr (std::is_same_v<Value, double>) {
            if (const auto* whole = std::get_if<std::int32_t>(&value)) return static_cast<double>(*whole);
            return unfit(name, "a number");
        }
    }
}

/// Converts text to a value of the type that the text looks like.
ConfigValue value_in(std::string_view text) {
    if (text == "true" || text == "false") return text == "true";
    if (const auto whole = parse_number<std::int32_t>(text)) return *whole;
    if (const auto number = parse_number<double>(text)) return *number;
    return text;
}

std::string text_of(const ConfigValue& value) {
    return std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
}

Error out_of_range(const char* name, const ConfigValue& value, std::string_view range) {
    return {Errc::kInvalidField, fmt::format("{} is {}; {}", name, text_of(value), range)};
}

/// Says which values a setting may have, e.g. "more than 0 and at most 10 m is needed".
std::string range_text(const ConfigField& field) {
    const auto& [low, high, low_is_excluded, high_is_excluded] = field.bounds;
    const std::string unit = *field.unit == '\0' ? "" : fmt::format(" {}", field.unit);
    if (!low_is_excluded && !high_is_excluded) return fmt::format("{:.6g} to {:.6g}{} is possible", low, high, unit);
    return fmt::format("{} {:.6g} and {} {:.6g}{} is needed", low_is_excluded ? "more than" : "at least", low,
                       high_is_excluded ? "less than" : "at most", high, unit);
}

Result<> check_bounds(const MapConfig& config) {
    for (const auto& field : kFields) {
        const bool fits = std::visit(
            [&]<class Value>(const ConfigField::Member<Value>& member) {
                if constexpr (std::is_enum_v<Value> || std::is_same_v<Value, bool>)
                    return true;
                else
                    return field.bounds.contain(config.*member.value);
            },
            field.member);
        if (!fits) return out_of_range(field.name, value_of(field, config), range_text(field));
    }
    return {};
}

Result<> check_occupancy(const MapConfig& c) {
    if (c.p_min > c.p_free) return out_of_range("p_min", c.p_min, "at most p_free is needed");
    if (c.p_max < c.p_occupied) return out_of_range("p_max", c.p_max, "at least p_occupied is needed");
    if (c.p_prior <= c.p_free || c.p_prior >= c.p_occupied) {
        return out_of_range("p_prior", c.p_prior,
                            "more than p_free and less than p_occupied is needed, or observations would have the "
                            "opposite effect");
    }
    const LogOdds prior = to_fixed(log_odds_of(c.p_prior));
    if (to_fixed(log_odds_of(c.p_occupied)) <= prior) {
        return out_of_range("p_occupied", c.p_occupied, "so close to p_prior a hit would have no effect; use more");
    }
    if (to_fixed(log_odds_of(c.p_free)) >= prior) {
        return out_of_range("p_free", c.p_free, "so close to p_prior a beam would free nothing; use less");
    }
    return {};
}

Result<> check_rays(const MapConfig& c) {
    if (c.hit_radius > 0.0 && c.ray_model != RayModel::kBresenham) {
        return out_of_range("hit_radius", c.hit_radius, "only ray_model bresenham has one; leave it at 0");
    }
    if (c.accumulate && c.ray_model == RayModel::kInverseSensorModel) {
        return out_of_range("accumulate", c.accumulate,
                            "ray_model inverse_sensor_model changes a cell once per scan; choose bresenham or "
                            "traversal");
    }
    return {};
}

Result<> check_classes(const MapConfig& c) {
    if (c.class_p_free >= c.class_p_occupied) {
        return out_of_range("class_p_free", c.class_p_free, "less than class_p_occupied is needed");
    }
    if (c.class_source == ClassSource::kOccupancy && c.class_p_occupied > c.p_max) {
        return out_of_range("class_p_occupied", c.class_p_occupied,
                            "at most p_max is needed, or no cell could reach it");
    }
    if (c.class_source == ClassSource::kOccupancy && c.class_p_free < c.p_min) {
        return out_of_range("class_p_free", c.class_p_free, "at least p_min is needed, or no cell could reach it");
    }
    if (c.class_himm_free >= c.class_himm_occupied) {
        return out_of_range("class_himm_free", c.class_himm_free, "less than class_himm_occupied is needed");
    }
    if (const double radius_max = kDangerCellsMax * c.cell_size; c.danger_radius > radius_max) {
        return out_of_range(
            "danger_radius", c.danger_radius,
            fmt::format("0 to {:g} m at this cell size, {} cells, is possible", radius_max, kDangerCellsMax));
    }
    return {};
}

Result<> check(const MapConfig& config) {
    for (const auto check_part : {check_bounds, check_occupancy, check_rays, check_classes}) {
        if (auto ok = check_part(config); !ok) return ok;
    }
    return {};
}

} // namespace

bool Bounds::contain(double value) const noexcept { // false for NaN
    return (low_is_excluded ? value > low : value >= low) && (high_is_excluded ? value < high : value <= high);
}

std::span<const std::string_view> choices_of(const ConfigField& field) noexcept {
    return std::visit(
        []<class Value>(const ConfigField::Member<Value>&) -> std::span<const std::string_view> {
            if constexpr (std::is_enum_v<Value>)
                return kNames<Value>;
            else
                return {};
        },
        field.member);
}

std::int32_t danger_reach(const MapConfig& config) noexcept {
    if (config.danger_radius == 0.0) return config.danger_cells;
    constexpr double kSnap = 1e-9; // 0.15 m are three cells of 0.05 m despite rounding
    return std::max(1, static_cast<std::int32_t>(std::ceil(config.danger_radius / config.cell_size - kSnap)));
}

std::span<const ConfigField> config_fields() noexcept { return kFields; }

const ConfigField* find_config_field(std::string_view name) noexcept {
    const auto found = std::ranges::find(kFields, name, [](const ConfigField& f) { return std::string_view(f.name); });
    return found == kFields.end() ? nullptr : &*found;
}

ConfigValue value_of(const ConfigField& field, const MapConfig& config) noexcept {
    return std::visit(
        [&]<class Value>(const ConfigField::Member<Value>& member) -> ConfigValue {
            const Value value = config.*member.value;
            if constexpr (std::is_enum_v<Value>) {
                return kNames<Value>[static_cast<std::size_t>(value)];
            } else {
                return value;
            }
        },
        field.member);
}

Result<> set_option(SessionOptions& options, const ConfigField& field, const ConfigValue& value) {
    return std::visit(
        [&]<class Value>(const ConfigField::Member<Value>& member) -> Result<> {
            const auto taken = as<Value>(field.name, value);
            if (!taken) return taken.error();
            options.*member.option = *taken;
            return {};
        },
        field.member);
}

Result<> set_option(SessionOptions& options, const ConfigField& field, std::string_view text) {
    return set_option(options, field, value_in(text));
}

Result<MapConfig> resolve(const SessionOptions& options) {
    MapConfig config;
    for (const auto& field : kFields) {
        std::visit(
            [&](const auto& member) { config.*member.value = (options.*member.option).value_or(config.*member.value); },
            field.member);
    }
    if (auto ok = check(config); !ok) return ok.error();
    return config;
}

SessionOptions options_of(const MapConfig& config) {
    SessionOptions options;
    for (const auto& field : kFields) {
        std::visit([&](const auto& member) { options.*member.option = config.*member.value; }, field.member);
    }
    return options;
}

Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted) {
    MapConfig asked = config;
    for (const auto& field : kFields) {
        std::visit(
            [&](const auto& member) { asked.*member.value = (wanted.*member.option).value_or(asked.*member.value); },
            field.member);
        const auto in_force = value_of(field, config);
        const auto other = value_of(field, asked);
        if (in_force == other) continue;
        return Error{Errc::kConflict,
                     fmt::format("the session exists with {0} {1}, {0} {2} was asked for; leave it out, or "
                                 "choose another session name",
                                 field.name, text_of(in_force), text_of(other))};
    }
    return {};
}

} // namespace scanloom::mapping
