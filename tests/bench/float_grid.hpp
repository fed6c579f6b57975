#pragma once

#include "common/scan/scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace scanloom::bench {

/// What the kernels are measured against: the usual small mapper, a fixed square of float log-odds around the
/// origin, each beam a Bresenham line of free cells with an occupied one at its end.
class FloatGrid {
public:
    FloatGrid(double side_m, double cell_size_m)
        : side_(static_cast<int>(std::lround(side_m / cell_size_m))), cells_per_metre_(1.0 / cell_size_m),
          cells_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.0F) {}

    void integrate(const Scan& scan, const Sensor& sensor) {
        const int i0 = index_of(scan.pose.x);
        const int j0 = index_of(scan.pose.y);
        for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
            const double direction = scan.pose.yaw + beam_angle(sensor.angles, beam);
            const bool hit = scan.ranges[beam] != kNoReturn && scan.ranges[beam] * 0.001 < sensor.range_max;
            const double range = hit ? scan.ranges[beam] * 0.001 : sensor.range_max;
            draw(i0, j0, index_of(scan.pose.x + range * std::cos(direction)),
                 index_of(scan.pose.y + range * std::sin(direction)), hit);
        }
    }

    [[nodiscard]] const std::vector<float>& cells() const noexcept { return cells_; }

private:
    [[nodiscard]] int index_of(double metres) const noexcept {
        return static_cast<int>(std::floor(metres * cells_per_metre_)) + side_ / 2;
    }

    void add(int i, int j, float amount) noexcept {
        if (i < 0 || j < 0 || i >= side_ || j >= side_) return;
        float& cell =
            cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(i)];
        cell = std::clamp(cell + amount, -6.907F, 6.907F);
    }

    /// Source  Bresenham, Algorithm for computer control of a digital plotter (IBM Systems Journal 1965).
    void draw(int i, int j, int i_end, int j_end, bool hit) noexcept {
        const int di = std::abs(i_end - i);
        const int dj = -std::abs(j_end - j);
        const int step_i = i < i_end ? 1 : -1;
        const int step_j = j < j_end ? 1 : -1;
        int error = di + dj;
        while (i != i_end || j != j_end) {
            add(i, j, -2.197F);
            const int doubled = 2 * error;
            if (doubled >= dj) {
                error += dj;
                i += step_i;
            }
            if (doubled <= di) {
                error += di;
                j += step_j;
            }
        }
        add(i, j, hit ? 2.197F : -2.197F);
    }

    int side_;
    double cells_per_metre_;
    std::vector<float> cells_;
};

} // namespace scanloom::bench
