#pragma once

#include "core/landmarks/clustering.hpp"

#include <deque>
#include <limits>

/// DBSCAN implemented directly from its definitions by comparing all pairs of points.
namespace scanloom::testing_support {

struct ClusteringOracle {
    const std::vector<Point2>& points;
    double eps;
    std::size_t min_points;

    [[nodiscard]] double squared(std::size_t a, std::size_t b) const {
        const double dx = points[a].x - points[b].x;
        const double dy = points[a].y - points[b].y;
        return dx * dx + dy * dy;
    }

    [[nodiscard]] bool near(std::size_t a, std::size_t b) const { return squared(a, b) <= eps * eps; }

    [[nodiscard]] bool is_core(std::size_t point) const {
        std::size_t count = 0;
        for (std::size_t other = 0; other < points.size(); ++other) count += near(point, other) ? 1 : 0;
        return count >= min_points;
    }

    [[nodiscard]] landmarks::Clustering run() const {
        std::vector<bool> core(points.size());
        for (std::size_t n = 0; n < points.size(); ++n) core[n] = is_core(n);
        landmarks::Clustering result{std::vector<std::int32_t>(points.size(), landmarks::kNoise), 0};
        for (std::size_t seed = 0; seed < points.size(); ++seed) {
            if (!core[seed] || result.cluster_of[seed] != landmarks::kNoise) continue;
            const auto cluster = static_cast<std::int32_t>(result.clusters++);
            std::deque<std::size_t> open{seed};
            result.cluster_of[seed] = cluster;
            for (; !open.empty(); open.pop_front()) {
                for (std::size_t n = 0; n < points.size(); ++n) {
                    if (!core[n] || result.cluster_of[n] != landmarks::kNoise || !near(open.front(), n)) continue;
                    result.cluster_of[n] = cluster;
                    open.push_back(n);
                }
            }
        }
        for (std::size_t n = 0; n < points.size(); ++n) {
            if (core[n]) continue;
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t other = 0; other < points.size(); ++other) {
                if (!core[other] || !near(n, other) || !(squared(n, other) < nearest)) continue;
                nearest = squared(n, other);
                result.cluster_of[n] = result.cluster_of[other];
            }
        }
        return result;
    }
};

} // namespace scanloom::testing_support
