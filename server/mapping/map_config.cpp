#include "server/mapping/map_config.hpp"

#include "server/classify/class_layer.hpp"
#include "server/mapping/log_odds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

namespace scanloom::mapping {
namespace {

using O = SessionOptions;
using C = MapConfig;

template <class Value>
ConfigField field(const char* name, std::optional<Value> O::*option, Value C::*value) {
    return {name, ConfigField::Member<Value>{option, value}};
}

const std::array kFields = {
    field("cell_size", &O::cell_size, &C::cell_size),
    field("ray_model", &O::ray_model, &C::ray_model),
    field("accumulate", &O::accumulate, &C::accumulate),
    field("hit_radius", &O::hit_radius, &C::hit_radius),
    field("drop_no_return", &O::drop_no_return, &C::drop_no_return),
    field("p_occupied", &O::p_occupied, &C::p_occupied),
    field("p_free", &O::p_free, &C::p_free),
    field("p_prior", &O::p_prior, &C::p_prior),
    field("p_min", &O::p_min, &C::p_min),
    field("p_max", &O::p_max, &C::p_max),
    field("obstacle_thickness", &O::obstacle_thickness, &C::obstacle_thickness),
    field("beam_aperture", &O::beam_aperture, &C::beam_aperture),
    field("himm_increment", &O::himm_increment, &C::himm_increment),
    field("himm_decrement", &O::himm_decrement, &C::himm_decrement),
    field("himm_obstacle_thickness", &O::himm_obstacle_thickness, &C::himm_obstacle_thickness),
    field("himm_beam_aperture", &O::himm_beam_aperture, &C::himm_beam_aperture),
    field("sonar_obstacle_thickness", &O::sonar_obstacle_thickness, &C::sonar_obstacle_thickness),
    field("sonar_beam_aperture", &O::sonar_beam_aperture, &C::sonar_beam_aperture),
    field("sonar_p_occupied_max", &O::sonar_p_occupied_max, &C::sonar_p_occupied_max),
    field("sonar_p_min", &O::sonar_p_min, &C::sonar_p_min),
    field("sonar_p_max", &O::sonar_p_max, &C::sonar_p_max),
    field("class_source", &O::class_source, &C::class_source),
    field("class_p_occupied", &O::class_p_occupied, &C::class_p_occupied),
    field("class_p_free", &O::class_p_free, &C::class_p_free),
    field("class_himm_occupied", &O::class_himm_occupied, &C::class_himm_occupied),
    field("class_himm_free", &O::class_himm_free, &C::class_himm_free),
    field("danger_cells", &O::danger_cells, &C::danger_cells),
    field("danger_radius", &O::danger_radius, &C::danger_radius),
    field("max_jump", &O::max_jump, &C::max_jump),
};

constexpr std::int32_t kDangerCellsMax = classify::ClassLayer::kDangerCellsMax;

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

/// Returns the number if the whole text is one.
template <class Number>
std::optional<Number> parse(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

/// Converts text to a value of the type that the text looks like.
ConfigValue value_in(std::string_view text) {
    if (text == "true" || text == "false") return text == "true";
    if (const auto whole = parse<std::int32_t>(text)) return *whole;
    if (const auto number = parse<double>(text)) return *number;
    return text;
}

std::string text_of(const ConfigValue& value) {
    return std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
}

Error out_of_range(const char* name, const ConfigValue& value, std::string_view range) {
    return {Errc::kInvalidField, fmt::format("{} is {}; {}", name, text_of(value), range)};
}

/// Each comparison is written so that NaN fails it.
Result<> check_within(const char* name, double value, double low, double high, std::string_view unit) {
    if (value >= low && value <= high) return {};
    return out_of_range(name, value, fmt::format("{:g} to {:g}{} is possible", low, high, unit));
}

Result<> check_positive(const char* name, double value, double high, std::string_view unit) {
    if (value > 0.0 && value <= high) return {};
    return out_of_range(name, value, fmt::format("more than 0 and at most {:g}{} is needed", high, unit));
}

Result<> check_count(const char* name, std::int32_t value, std::int32_t low, std::int32_t high) {
    if (value >= low && value <= high) return {};
    return out_of_range(name, value, fmt::format("{} to {} is possible", low, high));
}

Result<> check_occupancy(const MapConfig& c) {
    if (!(c.p_occupied > 0.5 && c.p_occupied < 1.0)) {
        return out_of_range("p_occupied", c.p_occupied, "more than 0.5 and less than 1 is needed");
    }
    if (!(c.p_free > 0.0 && c.p_free < 0.5)) {
        return out_of_range("p_free", c.p_free, "more than 0 and less than 0.5 is needed");
    }
    if (!(c.p_min >= 1e-6 && c.p_min <= c.p_free)) {
        return out_of_range("p_min", c.p_min, "at least 0.000001 and at most p_free is needed");
    }
    if (!(c.p_max <= 1.0 - 1e-6 && c.p_max >= c.p_occupied)) {
        return out_of_range("p_max", c.p_max, "at least p_occupied and at most 0.999999 is needed");
    }
    if (!(c.p_prior >= c.p_min && c.p_prior <= c.p_max)) {
        return out_of_range("p_prior", c.p_prior, "a probability from p_min to p_max is needed");
    }
    if (!(c.p_prior > c.p_free && c.p_prior < c.p_occupied)) {
        return out_of_range("p_prior", c.p_prior,
                            "more than p_free and less than p_occupied is needed, or evidence would count backwards");
    }
    const LogOdds prior = to_fixed(log_odds_of(c.p_prior));
    if (to_fixed(log_odds_of(c.p_occupied)) <= prior) {
        return out_of_range("p_occupied", c.p_occupied, "so close to p_prior a hit would count for nothing; use more");
    }
    if (to_fixed(log_odds_of(c.p_free)) >= prior) {
        return out_of_range("p_free", c.p_free, "so close to p_prior a beam would free nothing; use less");
    }
    return {};
}

Result<> check_rays(const MapConfig& c) {
    if (auto ok = check_within("hit_radius", c.hit_radius, 0.0, 1.0, " metres"); !ok) return ok;
    if (c.hit_radius > 0.0 && c.ray_model != RayModel::kBresenham) {
        return out_of_range("hit_radius", c.hit_radius, "only ray_model bresenham has one; leave it at 0");
    }
    if (c.accumulate && c.ray_model == RayModel::kInverseSensorModel) {
        return out_of_range("accumulate", c.accumulate,
                            "ray_model inverse_sensor_model changes a cell once a scan; choose bresenham or traversal");
    }
    return {};
}

Result<> check_sonar(const MapConfig& c) {
    if (!(c.sonar_p_occupied_max > 0.5 && c.sonar_p_occupied_max < 1.0)) {
        return out_of_range("sonar_p_occupied_max", c.sonar_p_occupied_max, "more than 0.5 and less than 1 is needed");
    }
    if (!(c.sonar_p_min >= 1e-6 && c.sonar_p_min < 0.5)) {
        return out_of_range("sonar_p_min", c.sonar_p_min, "at least 0.000001 and less than 0.5 is needed");
    }
    if (!(c.sonar_p_max <= 1.0 - 1e-6 && c.sonar_p_max > 0.5)) {
        return out_of_range("sonar_p_max", c.sonar_p_max, "more than 0.5 and at most 0.999999 is needed");
    }
    return {};
}

Result<> check_classes(const MapConfig& c) {
    if (!(c.class_p_occupied > 0.0 && c.class_p_occupied < 1.0)) {
        return out_of_range("class_p_occupied", c.class_p_occupied, "more than 0 and less than 1 is needed");
    }
    if (!(c.class_p_free > 0.0 && c.class_p_free < c.class_p_occupied)) {
        return out_of_range("class_p_free", c.class_p_free, "more than 0 and less than class_p_occupied is needed");
    }
    if (c.class_source == ClassSource::kOccupancy && c.class_p_occupied > c.p_max) {
        return out_of_range("class_p_occupied", c.class_p_occupied,
                            "at most p_max is needed, or no cell could reach it");
    }
    if (c.class_source == ClassSource::kOccupancy && c.class_p_free < c.p_min) {
        return out_of_range("class_p_free", c.class_p_free, "at least p_min is needed, or no cell could reach it");
    }
    if (auto ok = check_count("class_himm_occupied", c.class_himm_occupied, 1, 15); !ok) return ok;
    if (!(c.class_himm_free >= 0 && c.class_himm_free < c.class_himm_occupied)) {
        return out_of_range("class_himm_free", c.class_himm_free,
                            "at least 0 and less than class_himm_occupied is needed");
    }
    if (auto ok = check_count("danger_cells", c.danger_cells, 1, kDangerCellsMax); !ok) return ok;
    return check_within("danger_radius", c.danger_radius, 0.0, kDangerCellsMax * c.cell_size,
                        fmt::format(" metres at this cell size, {} cells,", kDangerCellsMax));
}

Result<> check(const MapConfig& c) {
    constexpr double kThicknessMax = 10.0;
    constexpr double kJumpMax = 100'000.0;
    if (!(c.cell_size >= 0.01 && c.cell_size <= 1.0)) {
        return out_of_range("cell_size", c.cell_size, "cells of 0.01 to 1.0 metres are possible");
    }
    for (const auto& ok :
         {check_occupancy(c), check_positive("obstacle_thickness", c.obstacle_thickness, kThicknessMax, " metres"),
          check_positive("beam_aperture", c.beam_aperture, std::numbers::pi, " radians"), check_rays(c),
          check_count("himm_increment", c.himm_increment, 1, 15),
          check_count("himm_decrement", c.himm_decrement, 1, 15),
          check_positive("himm_obstacle_thickness", c.himm_obstacle_thickness, kThicknessMax, " metres"),
          check_positive("himm_beam_aperture", c.himm_beam_aperture, std::numbers::pi, " radians"),
          check_positive("sonar_obstacle_thickness", c.sonar_obstacle_thickness, kThicknessMax, " metres"),
          check_positive("sonar_beam_aperture", c.sonar_beam_aperture, std::numbers::pi, " radians"), check_sonar(c),
          check_classes(c), check_within("max_jump", c.max_jump, 0.0, kJumpMax, " metres")}) {
        if (!ok) return ok;
    }
    return {};
}

} // namespace

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
