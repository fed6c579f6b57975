#include "server/landmarks/fusion.hpp"

#include "server/landmarks/matching.hpp"
#include "server/landmarks/median.hpp"
#include "server/landmarks/point_check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::landmarks {
namespace {

Point2 per_axis_median(const std::vector<Point2>& points) {
    std::vector<double> x;
    std::vector<double> y;
    for (const Point2& point : points) {
        x.push_back(point.x());
        y.push_back(point.y());
    }
    return {median(x), median(y)};
}

/// Points of different clouds, and where each group of them stands.
class Groups {
public:
    [[nodiscard]] Result<> add(const std::vector<Point2>& cloud, double threshold) {
        const auto matches = match(medians_, cloud, threshold);
        if (!matches) return matches.error();
        std::vector<bool> joined(cloud.size());
        for (const auto& [group, point, distance] : *matches) {
            members_[group].push_back(cloud[point]);
            medians_[group] = per_axis_median(members_[group]);
            joined[point] = true;
        }
        for (std::size_t n = 0; n < cloud.size(); ++n) {
            if (joined[n]) continue;
            members_.push_back({cloud[n]});
            medians_.push_back(cloud[n]);
        }
        return {};
    }

    [[nodiscard]] std::vector<FusedPoint> fused() const {
        std::vector<FusedPoint> points;
        points.reserve(medians_.size());
        for (std::size_t n = 0; n < medians_.size(); ++n) points.push_back({medians_[n], members_[n].size()});
        return points;
    }

private:
    std::vector<std::vector<Point2>> members_;
    std::vector<Point2> medians_;
};

Result<> check(std::span<const std::vector<Point2>> clouds, double threshold) {
    if (!(threshold >= 0.0) || !std::isfinite(threshold)) {
        return Error{Errc::kInvalidField,
                     fmt::format("threshold is {:g} m; it must be finite and 0 or more", threshold)};
    }
    for (std::size_t n = 0; n < clouds.size(); ++n) {
        if (auto good = check_points(clouds[n], fmt::format("clouds[{}]", n)); !good) return good;
    }
    return {};
}

} // namespace

Result<std::vector<FusedPoint>> fuse(std::span<const std::vector<Point2>> clouds, double threshold) {
    if (auto good = check(clouds, threshold); !good) return good.error();
    Groups groups;
    for (const auto& cloud : clouds) {
        if (auto added = groups.add(cloud, threshold); !added) return added.error();
    }
    return groups.fused();
}

} // namespace scanloom::landmarks
