#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/mapping/beam_fan.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace scanloom::bench {

/// The data of a conventional mapper: one value per cell of a fixed square around the origin, row by row.
template <class Value>
struct FlatMap {
    FlatMap(double half_side_m, double cell_size_m, Value initial)
        : cells_per_metre(1.0 / cell_size_m), half(static_cast<int>(std::ceil(half_side_m * cells_per_metre)) + 2),
          side(2 * half), cells(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), initial) {}

    /// Converts metres to a row or column.
    [[nodiscard]] int index_of(double metres) const noexcept {
        return static_cast<int>(std::floor(metres * cells_per_metre)) + half;
    }

    [[nodiscard]] std::size_t at(int i, int j) const noexcept {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(side) + static_cast<std::size_t>(i);
    }

    double cells_per_metre;
    int half;
    int side;
    std::vector<Value> cells;
};

/// The end of a beam, in metres in the map.
struct BeamEnd {
    double x;
    double y;
    bool is_hit;
};

/// Computes the ends of one sensor's beams, scan by scan. The beam directions are precomputed, as an efficient mapper
/// does: a scan rotates them by its heading and computes only the sine and cosine of that.
class BeamEnds {
public:
    explicit BeamEnds(const Sensor& sensor) : range_max_(sensor.range_max) {
        for (std::size_t beam = 0; beam < beam_count(sensor.angles); ++beam) {
            const double angle = beam_angle(sensor.angles, beam);
            directions_.push_back({std::cos(angle), std::sin(angle)});
        }
    }

    /// Returns the ends. Beams without a return end at range_max, invalid beams at the sensor. Valid until the next
    /// call.
    [[nodiscard]] const std::vector<BeamEnd>& of(const Scan& scan) {
        ends_.clear();
        const double cos_yaw = std::cos(scan.pose->yaw);
        const double sin_yaw = std::sin(scan.pose->yaw);
        for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
            const bool is_hit = scan.ranges[beam] != kNoReturn && scan.ranges[beam] * 0.001 < range_max_;
            const double range = is_hit ? scan.ranges[beam] * 0.001 : range_max_;
            const auto [x, y] = directions_[beam];
            ends_.push_back({scan.pose->x + range * (cos_yaw * x - sin_yaw * y),
                             scan.pose->y + range * (sin_yaw * x + cos_yaw * y),
                             is_hit && scan.ranges[beam] != kInvalidRange});
        }
        return ends_;
    }

private:
    double range_max_;
    std::vector<mapping::Direction> directions_;
    std::vector<BeamEnd> ends_;
};

/// Calls visit(index) for the cells of a line, except the last one.
/// Source  Bresenham, Algorithm for computer control of a digital plotter (IBM Systems Journal 1965).
template <class Visit>
void for_each_on_line(int i, int j, int i_end, int j_end, int side, Visit&& visit) {
    const int di = std::abs(i_end - i);
    const int dj = -std::abs(j_end - j);
    const int step_i = i < i_end ? 1 : -1;
    const int step_j = j < j_end ? side : -side;
    int error = di + dj;
    auto at = static_cast<std::ptrdiff_t>(j) * side + i;
    const auto end = static_cast<std::ptrdiff_t>(j_end) * side + i_end;
    while (at != end) {
        visit(static_cast<std::size_t>(at));
        const int doubled = 2 * error;
        if (doubled >= dj) {
            error += dj;
            at += step_i;
        }
        if (doubled <= di) {
            error += di;
            at += step_j;
        }
    }
}

} // namespace scanloom::bench
