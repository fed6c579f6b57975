#include "common/scan/beam_angles.hpp"

namespace scanloom {

std::size_t beam_count(const BeamAngles& angles) noexcept {
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) return uniform->count;
    if (const auto* stepped = std::get_if<SteppedAngles>(&angles)) return stepped->steps.size();
    return std::get_if<ExplicitAngles>(&angles)->size();
}

double beam_angle(const BeamAngles& angles, std::size_t index) noexcept {
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) {
        return uniform->first + static_cast<double>(index) * uniform->increment;
    }
    if (const auto* stepped = std::get_if<SteppedAngles>(&angles)) return stepped->unit * stepped->steps[index];
    return (*std::get_if<ExplicitAngles>(&angles))[index];
}

} // namespace scanloom
