#include "server/mapping/map_config.hpp"

#include <fmt/format.h>

namespace scanloom::mapping {
namespace {

constexpr ConfigField kFields[] = {
    {"cell_size", &SessionOptions::cell_size, &MapConfig::cell_size},
    {"p_occupied", &SessionOptions::p_occupied, &MapConfig::p_occupied},
    {"p_free", &SessionOptions::p_free, &MapConfig::p_free},
    {"p_prior", &SessionOptions::p_prior, &MapConfig::p_prior},
    {"p_min", &SessionOptions::p_min, &MapConfig::p_min},
    {"p_max", &SessionOptions::p_max, &MapConfig::p_max},
    {"obstacle_thickness", &SessionOptions::obstacle_thickness, &MapConfig::obstacle_thickness},
    {"beam_aperture", &SessionOptions::beam_aperture, &MapConfig::beam_aperture},
};

Error out_of_range(const char* field, double value, const char* range) {
    return {Errc::kInvalidField, fmt::format("{} is {}; {}", field, value, range)};
}

/// The comparisons are written so that NaN fails them.
Result<> check(const MapConfig& c) {
    if (!(c.cell_size >= 0.01 && c.cell_size <= 1.0)) {
        return out_of_range("cell_size", c.cell_size, "cells of 0.01 to 1.0 metres are possible");
    }
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
    if (!(c.obstacle_thickness > 0.0 && c.obstacle_thickness <= 10.0)) {
        return out_of_range("obstacle_thickness", c.obstacle_thickness, "more than 0 and at most 10 metres are needed");
    }
    if (!(c.beam_aperture > 0.0 && c.beam_aperture <= std::numbers::pi)) {
        return out_of_range("beam_aperture", c.beam_aperture, "more than 0 and at most pi radians are needed");
    }
    return {};
}

} // namespace

std::span<const ConfigField> config_fields() noexcept { return kFields; }

Result<MapConfig> resolve(const SessionOptions& options) {
    MapConfig config;
    for (const auto& field : kFields) {
        if (options.*field.option) config.*field.value = *(options.*field.option);
    }
    if (auto ok = check(config); !ok) return ok.error();
    return config;
}

SessionOptions options_of(const MapConfig& config) {
    SessionOptions options;
    for (const auto& field : kFields) options.*field.option = config.*field.value;
    return options;
}

Result<> check_agreement(const MapConfig& config, const SessionOptions& wanted) {
    for (const auto& field : kFields) {
        if (!(wanted.*field.option) || *(wanted.*field.option) == config.*field.value) continue;
        return Error{Errc::kConflict,
                     fmt::format("the session exists with {0} {1}, {0} {2} was asked for; leave it out, or "
                                 "choose another session name",
                                 field.name, config.*field.value, *(wanted.*field.option))};
    }
    return {};
}

} // namespace scanloom::mapping
