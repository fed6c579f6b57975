#pragma once

#include "tests/support/inverse_sensor_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace scanloom::oracle {

/// Returns the same as sighting_at() without examining every beam. For scans too large for a loop over all beams.
class BeamIndex {
public:
    explicit BeamIndex(const Scene& scene) : sight_(scene.sight) {
        for (std::size_t b = 0; b < scene.beam_angles.size(); ++b) {
            sorted_.emplace_back(std::remainder(scene.beam_angles[b], 2.0 * std::numbers::pi), b);
        }
        std::sort(sorted_.begin(), sorted_.end());
    }

    [[nodiscard]] Sighting operator()(double phi) const {
        phi = std::remainder(phi, 2.0 * std::numbers::pi);
        const auto from = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(phi, std::size_t{0}));
        const auto next = static_cast<std::size_t>(from - sorted_.begin());
        const std::size_t count = sorted_.size();
        const auto at = [&](std::size_t n) { return sorted_[n % count]; };
        const double ahead = turn_between(phi, at(next).first);
        const double behind = turn_between(phi, at(next + count - 1).first);
        const double nearest = std::min(ahead, behind);

        std::size_t beam = count; // the lowest index of the equally near beams, up to rounding
        for (std::size_t n = next; n < next + count && turn_between(phi, at(n).first) < nearest + 1e-12; ++n) {
            beam = std::min(beam, at(n).second);
        }
        for (std::size_t n = next + count; n-- > next && turn_between(phi, at(n).first) < nearest + 1e-12;) {
            beam = std::min(beam, at(n).second);
        }
        return {beam, nearest <= sight_.beta / 2.0 ||
                          (sight_.gap_max > 0.0 &&
                           turn_to(at(next + count - 1).first, phi) + turn_to(phi, at(next).first) <= sight_.gap_max)};
    }

private:
    Sight sight_;
    std::vector<std::pair<double, std::size_t>> sorted_; // angle in [-pi, pi], beam
};

} // namespace scanloom::oracle
