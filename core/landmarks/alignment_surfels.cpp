#include "core/landmarks/alignment_surfels.hpp"

#include "core/landmarks/points.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace scanloom::landmarks {
namespace {

constexpr int kStraightPointsMin = 5;
constexpr double kStraight = 0.15; // a straight surface's variance across / variance along, at most
constexpr double kExtent = 4e-4;   // square metres, a straight surface's variance along, at least

using CellKey = std::pair<std::int64_t, std::int64_t>; // (y, x)

/// Sums over points, relative to a point of the cloud, so that no precision is lost far from the origin.
struct Moments {
    int count = 0;
    Point2 sum{0.0, 0.0};
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();

    void add(const Point2& point) {
        ++count;
        sum += point;
        const Eigen::Vector2d column = to_eigen(point);
        squares += column * column.transpose();
    }
    void add(const Moments& other) {
        count += other.count;
        sum += other.sum;
        squares += other.squares;
    }
    [[nodiscard]] Point2 mean() const { return sum / count; }
    [[nodiscard]] Eigen::Matrix2d covariance() const {
        const Eigen::Vector2d column = to_eigen(mean());
        return squares / count - column * column.transpose();
    }
};

using Cells = std::map<CellKey, Moments>;

/// Returns the moments of all points in a square and in its eight neighbours.
Moments around(const Cells& cells, CellKey key) {
    Moments all;
    for (std::int64_t y = key.first - 1; y <= key.first + 1; ++y) {
        for (auto cell = cells.lower_bound({y, key.second - 1}); cell != cells.end(); ++cell) {
            if (cell->first > CellKey{y, key.second + 1}) break;
            all.add(cell->second);
        }
    }
    return all;
}

Surfel surfel(const Cells& cells, CellKey key, const Moments& moments) {
    Surfel surfel{.position = moments.mean()};
    const Moments all = around(cells, key);
    if (all.count < kStraightPointsMin) return surfel;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(all.covariance());
    if (axes.eigenvalues()[1] < kExtent || axes.eigenvalues()[0] > kStraight * axes.eigenvalues()[1]) return surfel;
    surfel.normal = from_eigen(axes.eigenvectors().col(0));
    surfel.position += surfel.normal * dot(surfel.normal, all.mean() - surfel.position);
    return surfel;
}

} // namespace

std::vector<Surfel> surfels_of(std::span<const std::vector<Point2>> clouds) {
    std::vector<Surfel> surfels;
    const auto any = std::ranges::find_if(clouds, [](const auto& points) { return !points.empty(); });
    if (any == clouds.end()) return surfels;
    const Point2 origin = any->front();
    constexpr double kCellsPerMetre = 1.0 / kSurfelSpacing;
    Cells cells;
    for (const auto& points : clouds) {
        for (const Point2& point : points) {
            const Point2 offset = point - origin;
            cells[{static_cast<std::int64_t>(std::floor(offset.y * kCellsPerMetre)),
                   static_cast<std::int64_t>(std::floor(offset.x * kCellsPerMetre))}]
                .add(offset);
        }
    }
    for (const auto& [key, moments] : cells) {
        surfels.push_back(surfel(cells, key, moments));
        surfels.back().position += origin;
    }
    return surfels;
}

Surfel transformed(const Pose2& T_a_b, const Surfel& surfel_b) {
    const Pose2 rotation{0.0, 0.0, T_a_b.yaw};
    return {transform(T_a_b, surfel_b.position), transform(rotation, surfel_b.normal)};
}

std::vector<Point2> positions_of(std::span<const Surfel> surfels) {
    std::vector<Point2> positions;
    positions.reserve(surfels.size());
    for (const Surfel& surfel : surfels) positions.push_back(surfel.position);
    return positions;
}

} // namespace scanloom::landmarks
