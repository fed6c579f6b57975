#include "lab/scoring.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::lab {
namespace {

constexpr double kHairsBreadth = 1e-6; // metres: decides on which side of a wall a point is

/// Decides which points can be seen from a trajectory.
class Views {
public:
    Views(const sim::World& world, const Sensor& laser, std::span<const Pose2> path)
        : obstacles_(*world.obstacles), path_(path), range_max_(laser.range_max),
          first_angle_(beam_angle(laser.angles, 0)),
          last_angle_(beam_angle(laser.angles, beam_count(laser.angles) - 1)) {}

    [[nodiscard]] bool see(const Point2& point) const {
        return std::any_of(path_.begin(), path_.end(), [&](const Pose2& pose) { return sees(pose, point); });
    }

private:
    [[nodiscard]] bool sees(const Pose2& pose, const Point2& point) const {
        const double dx = point.x - pose.x;
        const double dy = point.y - pose.y;
        const double square = dx * dx + dy * dy;
        if (square >= range_max_ * range_max_) return false;
        const double yaw = std::atan2(dy, dx);
        const double angle = normalize_angle(yaw - pose.yaw);
        if (angle < first_angle_ - kHairsBreadth || angle > last_angle_ + kHairsBreadth) return false;
        const double length = std::sqrt(square);
        return obstacles_.cast_ray({pose.x, pose.y}, yaw, length) >= length - kHairsBreadth;
    }

    const sim::Obstacles& obstacles_;
    std::span<const Pose2> path_;
    double range_max_;
    double first_angle_;
    double last_angle_;
};

void see_free_cells(const sim::GroundTruthGrid& truth, const Views& views, CellMask& seen) {
    for_each_cell(seen.box, [&](grid::Cell cell) {
        if (truth.at(cell.i, cell.j) != sim::GroundTruth::kFree) return;
        seen.at(cell) = views.see({(cell.i + 0.5) * truth.cell_size, (cell.j + 0.5) * truth.cell_size});
    });
}

void see_side(const sim::Segment& side, double cell_size_m, const Views& views, CellMask& seen) {
    const Point2 begin{side.ax, side.ay};
    const Point2 along = Point2{side.bx, side.by} - begin;
    const Point2 inward = Point2{-along.y, along.x} / norm(along) * kHairsBreadth; // sides run counter-clockwise
    const int steps = static_cast<int>(std::ceil(norm(along) / std::min(0.02, cell_size_m / 4.0)));
    for (int n = 0; n < steps; ++n) {
        const Point2 point = begin + (n + 0.5) / steps * along;
        const Point2 in_cells = (point + inward) / cell_size_m;
        const grid::Cell cell{static_cast<std::int32_t>(std::floor(in_cells.x)),
                              static_cast<std::int32_t>(std::floor(in_cells.y))};
        if (seen.contains(cell) && !seen.at(cell)) seen.at(cell) = views.see(point);
    }
}

} // namespace

CellMask visible_cells(const sim::World& world, const sim::GroundTruthGrid& truth, const Sensor& laser,
                       std::span<const Pose2> path, const grid::CellBox& box) {
    const Views views(world, laser, path);
    CellMask seen(box, 0);
    see_free_cells(truth, views, seen);
    for (const sim::Segment& side : world.outlines) see_side(side, truth.cell_size, views, seen);
    return seen;
}

namespace {

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Intersection over union of two sets, from the share of each that agrees: 1 / (1 / precision + 1 / recall - 1).
double jaccard(double precision, double recall) {
    const double product = precision * recall;
    return product == 0.0 ? 0.0 : product / (precision + recall - product);
}

/// Returns the cells within the tolerance of cells with this value.
template <class Value>
CellMask around(const CellGrid<Value>& grid, Value value) {
    CellMask mask(grid.box, 0);
    for_each_cell(grid.box, [&](grid::Cell cell) {
        if (grid.at(cell) != value) return;
        for (std::int32_t j = cell.j - kTolerance; j <= cell.j + kTolerance; ++j) {
            for (std::int32_t i = cell.i - kTolerance; i <= cell.i + kTolerance; ++i) {
                if (mask.contains({i, j})) mask.at({i, j}) = 1;
            }
        }
    });
    return mask;
}

} // namespace

Scores score(const StateGrid& map, const GroundTruthCells& truth, const CellMask& seen, const CellMask& walked) {
    assert(map.box == truth.box && map.box == seen.box && map.box == walked.box);
    const CellMask near_solid = around(truth, sim::GroundTruth::kOccupied);
    const CellMask near_occupied = around(map, CellState::kOccupied);
    Scores scores;
    std::size_t matched = 0;
    std::size_t outside = 0; // not in a solid
    std::size_t surface = 0;
    std::size_t found = 0;
    std::size_t found_exactly = 0;
    std::size_t open = 0;
    std::size_t open_found = 0;
    for_each_cell(map.box, [&](grid::Cell cell) {
        const bool is_occupied = map.at(cell) == CellState::kOccupied;
        const bool is_solid = truth.at(cell) == sim::GroundTruth::kOccupied;
        if (is_occupied) {
            ++scores.occupied;
            matched += near_solid.at(cell);
            outside += !is_solid;
            scores.residue += !near_solid.at(cell) && walked.at(cell);
        }
        if (!seen.at(cell)) return;
        if (is_solid) {
            ++surface;
            found += near_occupied.at(cell);
            found_exactly += is_occupied;
        } else if (truth.at(cell) == sim::GroundTruth::kFree && !near_solid.at(cell)) {
            ++open;
            open_found += map.at(cell) == CellState::kFree;
        }
    });
    scores.precision = share(matched, scores.occupied);
    scores.recall = share(found, surface);
    scores.iou = jaccard(scores.precision, scores.recall);
    scores.iou_exact = share(found_exactly, outside + surface);
    scores.free_recall = share(open_found, open);
    return scores;
}

} // namespace scanloom::lab
