#include "lab/matrix.hpp"

#include <numbers>

namespace scanloom::lab {
namespace {

using MaybeNoise = std::optional<sim::Noise>;

sim::Noise uniform(double width_m) { return {.range = 0.0, .range_uniform = width_m, .beam_angle = 0.0}; }

std::vector<Scene> scenes() { return {{"static", "room"}, {"dynamic", "room_walker"}}; }

std::vector<RayModelChoice> ray_models() {
    return {
        {"inverse_sensor_model", [](SessionOptions& options) { options.ray_model = RayModel::kInverseSensorModel; }},
        {"bresenham", [](SessionOptions& options) { options.ray_model = RayModel::kBresenham; }},
        {"traversal", [](SessionOptions& options) { options.ray_model = RayModel::kTraversal; }},
    };
}

constexpr NoiseChoice kNoNoise{"none", [](double) { return MaybeNoise{}; }, false};
constexpr NoiseChoice kGaussian{"gaussian", [](double) { return MaybeNoise(sim::Noise{}); }, true};
constexpr NoiseChoice kOneCell{"1_cell", [](double cell_size_m) { return MaybeNoise(uniform(cell_size_m)); }, false};
constexpr NoiseChoice kThreeCells{"3_cells", [](double cell_size_m) { return MaybeNoise(uniform(3.0 * cell_size_m)); },
                                  false};

// In opposite corners of the room, in the map frame; from there the robot follows the walls.
constexpr Start kSouthWest{"south_west", {-3.5, -3.8, 0.0}};
constexpr Start kNorthEast{"north_east", {3.5, 3.6, std::numbers::pi}};

} // namespace

Matrix full_matrix() {
    return {scenes(),
            {0.01, 0.05, 0.1, 0.5},
            ray_models(),
            {kNoNoise, kGaussian, kOneCell, kThreeCells},
            {kSouthWest, kNorthEast},
            kScansDefault,
            1};
}

Matrix quick_matrix() {
    return {scenes(), {0.1, 0.5}, ray_models(), {kNoNoise, kGaussian}, {kSouthWest}, kScansDefault, 1};
}

} // namespace scanloom::lab
