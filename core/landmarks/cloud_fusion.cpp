#include "core/landmarks/cloud_fusion.hpp"

#include "core/landmarks/landmark_matching.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace scanloom::landmarks {
namespace {

/// Numbers in ascending order, with their median.
class Sorted {
public:
    void add(double number) { numbers_.insert(std::ranges::upper_bound(numbers_, number), number); }

    /// Precondition: there is at least one number.
    [[nodiscard]] double median() const {
        const std::size_t half = numbers_.size() / 2;
        return numbers_.size() % 2 == 1 ? numbers_[half] : (numbers_[half - 1] + numbers_[half]) / 2.0;
    }

    [[nodiscard]] std::size_t size() const noexcept { return numbers_.size(); }

private:
    std::vector<double> numbers_;
};

/// Points of different clouds that correspond.
struct Group {
    std::size_t began = 0; ///< index of the cloud that started the group
    Sorted x;
    Sorted y;

    void add(const Point2& point) {
        x.add(point.x);
        y.add(point.y);
    }
};

/// Groups by the squares that contain them, so that a cloud is only matched with nearby groups.
class Squares {
public:
    explicit Squares(double threshold) : reach_(threshold), side_(std::max(threshold, 0.5)) {}

    void put(std::uint32_t group, const Point2& place) { groups_[key_of(place.x, place.y)].push_back(group); }

    void move(std::uint32_t group, const Point2& from, const Point2& to) {
        const auto before = key_of(from.x, from.y);
        if (before == key_of(to.x, to.y)) return;
        std::erase(groups_[before], group);
        put(group, to);
    }

    /// Returns all groups within the threshold of any of the points, and some around them, ascending.
    [[nodiscard]] std::vector<std::uint32_t> near_to(const std::vector<Point2>& cloud) const {
        std::vector<std::uint64_t> keys;
        for (const auto& point : cloud) { // a square is at least as large as the threshold, so these are all
            for (const double y : {point.y - reach_, point.y, point.y + reach_}) {
                for (const double x : {point.x - reach_, point.x, point.x + reach_}) keys.push_back(key_of(x, y));
            }
        }
        std::ranges::sort(keys);
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        std::vector<std::uint32_t> found;
        for (const auto key : keys) {
            const auto square = groups_.find(key);
            if (square != groups_.end()) found.insert(found.end(), square->second.begin(), square->second.end());
        }
        std::ranges::sort(found);
        return found;
    }

private:
    /// Returns the key of a square. Squares far outside share a key, which only means that more groups are compared.
    [[nodiscard]] std::uint64_t key_of(double x, double y) const {
        const auto number = [&](double metres) {
            constexpr double kFarthest = 1 << 30;
            return static_cast<std::uint32_t>(
                static_cast<std::int32_t>(std::clamp(std::floor(metres / side_), -kFarthest, kFarthest)));
        };
        return std::uint64_t{number(y)} << 32 | number(x);
    }

    const double reach_;
    const double side_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> groups_;
};

/// Groups of points of different clouds, and the position of each group.
class Groups {
public:
    explicit Groups(double threshold) : threshold_(threshold), squares_(threshold) {}

    [[nodiscard]] Result<> add(const std::vector<Point2>& cloud, std::size_t number) {
        const auto near = squares_.near_to(cloud);
        std::vector<Point2> places;
        for (const auto group : near) places.push_back(medians_[group]);
        const auto matches = match(places, cloud, threshold_);
        if (!matches) return matches.error();
        std::vector<bool> joined(cloud.size());
        for (const auto& found : *matches) {
            join(near[found.first], cloud[found.second]);
            joined[found.second] = true;
        }
        for (std::size_t n = 0; n < cloud.size(); ++n) {
            if (!joined[n]) begin(cloud[n], number);
        }
        return {};
    }

    [[nodiscard]] std::vector<FusedPoint> fused() const {
        std::vector<FusedPoint> points;
        points.reserve(medians_.size());
        for (std::size_t n = 0; n < medians_.size(); ++n) {
            points.push_back({medians_[n], groups_[n].x.size(), groups_[n].began});
        }
        return points;
    }

private:
    void begin(const Point2& point, std::size_t number) {
        squares_.put(static_cast<std::uint32_t>(medians_.size()), point);
        groups_.push_back({number, {}, {}});
        groups_.back().add(point);
        medians_.push_back(point);
    }

    void join(std::uint32_t group, const Point2& point) {
        groups_[group].add(point);
        const Point2 place{groups_[group].x.median(), groups_[group].y.median()};
        squares_.move(group, medians_[group], place);
        medians_[group] = place;
    }

    const double threshold_;
    std::vector<Group> groups_;
    std::vector<Point2> medians_; // positions of the groups
    Squares squares_;
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

Result<std::vector<FusedPoint>> fuse(std::span<const std::vector<Point2>> clouds, double threshold,
                                     const std::function<Result<>()>& ask) {
    if (auto good = check(clouds, threshold); !good) return good.error();
    Groups groups(threshold);
    for (std::size_t n = 0; n < clouds.size(); ++n) {
        if (auto asked = ask(); !asked) return asked.error();
        if (auto added = groups.add(clouds[n], n); !added) return added.error();
    }
    return groups.fused();
}

Result<std::vector<CloudPoint>> fuse_captures(std::span<const RobotCapture> captures, double threshold,
                                              const std::function<Result<>()>& ask) {
    std::vector<std::vector<Point2>> clouds;
    clouds.reserve(captures.size());
    for (const auto& one : captures) clouds.push_back(in_metres(one.capture.points));
    const auto fused = fuse(clouds, threshold, ask);
    if (!fused) return fused.error();
    std::vector<CloudPoint> points;
    points.reserve(fused->size());
    for (const auto& point : *fused) {
        const auto& [robot, capture, ended] = captures[point.first];
        const Point2 from_robot = transform(inverse(capture.pose), point.position);
        points.push_back(
            {std::atan2(from_robot.y, from_robot.x), norm(from_robot), point.position, point.clouds, robot, ended});
    }
    return points;
}

} // namespace scanloom::landmarks
