#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <tuple>

namespace scanloom::landmarks {

Result<> check_points(std::span<const Point2> points, std::string_view name) {
    if (points.size() > kCloudPointsMax) {
        return Error{Errc::kTooLarge, fmt::format("{} are {}, more than the {} points of one cloud: give fewer", name,
                                                  points.size(), kCloudPointsMax)};
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (!is_finite(points[n])) {
            return Error{Errc::kInvalidField, fmt::format("{}[{}] is not finite: leave it out", name, n)};
        }
        if (max_abs(points[n]) > kPointCoordinateMax) {
            return Error{Errc::kInvalidField,
                         fmt::format("{}[{}] is ({}, {}), further than {} m from the origin: leave it out", name, n,
                                     points[n].x, points[n].y, kPointCoordinateMax)};
        }
    }
    return {};
}

namespace {

struct CellPlace {
    double x;
    double y;
    std::uint32_t index;

    [[nodiscard]] bool operator<(const CellPlace& other) const {
        return std::tie(x, y, index) < std::tie(other.x, other.y, other.index);
    }
    [[nodiscard]] bool is_at(const CellPlace& other) const { return x == other.x && y == other.y; }
};

std::vector<CellPlace> sorted_places(std::span<const Point2> cloud) {
    std::vector<CellPlace> places(cloud.size());
    for (std::uint32_t n = 0; n < places.size(); ++n) places[n] = {cloud[n].x, cloud[n].y, n};
    std::sort(places.begin(), places.end());
    return places;
}

} // namespace

DistinctPoints distinct_points(std::span<const Point2> cloud) {
    assert(cloud.size() <= kCloudPointsMax);
    DistinctPoints distinct;
    distinct.of.resize(cloud.size());
    const std::vector<CellPlace> places = sorted_places(cloud);
    for (std::size_t n = 0, first = 0; n < places.size(); ++n) {
        if (!places[n].is_at(places[first])) first = n;
        distinct.of[places[n].index] =
            places[first].index; // index in the cloud; replaced by the number of the distinct point below
    }
    for (std::uint32_t n = 0; n < cloud.size(); ++n) {
        const std::uint32_t first = distinct.of[n];
        if (first == n) {
            distinct.of[n] = static_cast<std::uint32_t>(distinct.points.size());
            distinct.points.push_back(cloud[n]);
            distinct.counts.push_back(1);
        } else {
            distinct.of[n] = distinct.of[first];
            ++distinct.counts[distinct.of[n]];
        }
    }
    return distinct;
}

} // namespace scanloom::landmarks
