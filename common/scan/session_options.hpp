#pragma once

#include "common/scan/class_source.hpp"
#include "common/scan/ray_model.hpp"

#include <cstdint>
#include <optional>

namespace scanloom {

/// The requested settings of a session's maps; an absent setting takes its default. server/mapping/map_config.hpp
/// documents the meaning, unit, range and default of each, and validates them.
struct SessionOptions {
    std::optional<double> cell_size;

    std::optional<RayModel> ray_model;
    std::optional<bool> accumulate;
    std::optional<double> hit_radius;
    std::optional<bool> drop_no_return;
    std::optional<double> p_occupied;
    std::optional<double> p_free;
    std::optional<double> p_prior;
    std::optional<double> p_min;
    std::optional<double> p_max;
    std::optional<double> obstacle_thickness;
    std::optional<double> beam_aperture;

    std::optional<std::int32_t> himm_increment;
    std::optional<std::int32_t> himm_decrement;
    std::optional<double> himm_obstacle_thickness;
    std::optional<double> himm_beam_aperture;

    std::optional<double> sonar_obstacle_thickness;
    std::optional<double> sonar_beam_aperture;
    std::optional<double> sonar_p_occupied_max;
    std::optional<double> sonar_p_min;
    std::optional<double> sonar_p_max;

    std::optional<ClassSource> class_source;
    std::optional<double> class_p_occupied;
    std::optional<double> class_p_free;
    std::optional<std::int32_t> class_himm_occupied;
    std::optional<std::int32_t> class_himm_free;
    std::optional<std::int32_t> danger_cells;
    std::optional<double> danger_radius;
    std::optional<double> max_jump;

    friend bool operator==(const SessionOptions&, const SessionOptions&) = default;
};

} // namespace scanloom
