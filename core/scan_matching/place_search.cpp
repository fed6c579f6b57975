#include "core/scan_matching/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::scan_matching {
namespace {

constexpr int kTopLevel = PlaceMap::kLevels - 1;
constexpr int kFractionBits = 10;
constexpr std::int32_t kFraction = 1 << kFractionBits; // of a cell

std::int32_t rounded_down(double value) { return static_cast<std::int32_t>(std::floor(value)); }

double cell_of(int level) { return SeenSpace::kCell * static_cast<double>(std::int32_t{1} << level); }

} // namespace

PlaceSearch::PlaceSearch(std::shared_ptr<const PlaceMap> map, std::span<const SurfacePoint> points,
                         const PlaceQuestion& question)
    : map_(std::move(map)), question_(question), least_(question.score_min) {
    for (const SurfacePoint& point : points) {
        const Point2 at{point.x, point.y};
        if (at.x * at.x + at.y * at.y > PlaceMap::kReach * PlaceMap::kReach) continue;
        points_.push_back({at, direction_of(point), std::sqrt(at.x * at.x + at.y * at.y), point});
    }
    for (int level = 0; level <= kTopLevel; ++level) {
        rotations_[static_cast<std::size_t>(level)].resize(static_cast<std::size_t>(turns_of(level)));
    }
}

bool PlaceSearch::run(std::size_t lookups) {
    while (!has_ended_ && lookups_ < lookups) {
        if (roots_ < turns_of(kTopLevel)) {
            push_roots(roots_++);
        } else if (open_.empty() || open_.top().bound < least_) {
            end(least_ - 1);
        } else {
            const Node node = open_.top();
            open_.pop();
            open(node);
        }
    }
    return has_ended_;
}

void PlaceSearch::end(int rival_score) {
    has_ended_ = true;
    if (best_) best_->rival_score = rival_score;
    open_ = {};
    rotations_ = {};
}

/// Looks at the poses of a node that may be better than those of all others.
void PlaceSearch::open(const Node& node) {
    if (best_ && is_close(node)) return;
    if (node.level > 0) {
        push_children(node);
    } else if (best_) {
        end(node.bound);
    } else {
        const auto [x, y] = middle_of(node);
        best_ = {{x, y, sin_cos(angle_of_turn(0, node.turn))}, node.bound, 0};
        best_node_ = node;
        least_ = std::max(least_, static_cast<int>(question_.rival_share * node.bound) + 1);
    }
}

double PlaceSearch::turn_of(int level) { return 2.0 * std::numbers::pi / static_cast<double>(turns_of(level)); }

double PlaceSearch::angle_of_turn(int level, std::int32_t turn) {
    return (static_cast<double>(turn) + 0.5) * turn_of(level) - std::numbers::pi;
}

void PlaceSearch::push_roots(std::int32_t turn) {
    const PlaceMap::Grid& top = map_->bounds(kTopLevel).front();
    for (std::int32_t row = 0; row < top.height; ++row) {
        for (std::int32_t column = 0; column < top.width; ++column) push({0, kTopLevel, column, row, turn});
    }
}

void PlaceSearch::push_children(const Node& node) {
    for (std::int32_t k = 0; k < 2; ++k) {
        for (std::int32_t j = 0; j < 2; ++j) {
            for (std::int32_t i = 0; i < 2; ++i) {
                push({0, node.level - 1, 2 * node.column + i, 2 * node.row + j, 2 * node.turn + k});
            }
        }
    }
}

/// Returns the points, turned by an interval of rotations of a level.
const PlaceSearch::Rotation& PlaceSearch::rotation(int level, std::int32_t turn) {
    Rotation& rotation = rotations_[static_cast<std::size_t>(level)][static_cast<std::size_t>(turn)];
    if (!rotation.empty()) return rotation;
    const double angle = angle_of_turn(level, turn);
    const SinCos turned = sin_cos(angle);
    const double scale = kFraction / cell_of(level);
    const double tolerance = level == 0 ? 0.0 : 0.5 * turn_of(level);
    rotation.reserve(points_.size());
    for (const auto& [at, direction, distance, surface] : points_) {
        const std::int32_t x = rounded_down((turned.cos * at.x - turned.sin * at.y) * scale);
        const std::int32_t y = rounded_down((turned.sin * at.x + turned.cos * at.y) * scale);
        const PlaceMap::Bits bits = PlaceMap::facing(surface, direction + angle, tolerance);
        // The origin is anywhere in the cell, and the rotation moves the point by up to `shift`; at the finest level,
        // there is one pose, with the origin in the middle.
        const std::int32_t shift = level == 0 ? -kFraction / 2 : rounded_down(distance * tolerance * scale) + 2;
        const std::int32_t column = (x + kFraction + shift) >> kFractionBits;
        const std::int32_t row = (y + kFraction + shift) >> kFractionBits;
        const bool is_wide = column - ((x - shift) >> kFractionBits) > 1;
        const bool is_high = row - ((y - shift) >> kFractionBits) > 1;
        rotation.push_back({static_cast<std::int16_t>(column), static_cast<std::int16_t>(row), bits,
                            static_cast<std::uint8_t>((is_wide ? 1 : 0) + (is_high ? 2 : 0))});
    }
    return rotation;
}

/// Adds a node, unless its bound is too low.
void PlaceSearch::push(Node node) {
    const PlaceMap::Grid* grids = node.level == 0 ? &map_->cells() : map_->bounds(node.level).data();
    if ((grids->at(node.column, node.row) & PlaceMap::kPassed) == 0 || !is_within(node)) return;
    const Rotation& points = rotation(node.level, node.turn);
    int bound = static_cast<int>(points.size()); // if all others match
    std::size_t n = 0;
    while (n < points.size() && bound >= least_) {
        const Rotated& point = points[n++];
        const PlaceMap::Bits bits = grids[point.square].at(point.column + node.column, point.row + node.row);
        const int penalty = (bits & PlaceMap::kOpen) != 0 ? 1 : 2;
        bound -= (bits & point.facing) == 0 ? penalty : 0; // no branch: it would be predicted poorly
    }
    lookups_ += n;
    node.bound = bound;
    if (bound >= least_) open_.push(node);
}

Point2 PlaceSearch::middle_of(const Node& node) const {
    const double cell = cell_of(node.level);
    return {map_->corner().x + (static_cast<double>(node.column) + 0.5) * cell,
            map_->corner().y + (static_cast<double>(node.row) + 0.5) * cell};
}

/// Returns whether poses of a node may be in the circle of the question; at the finest level, whether its one is.
bool PlaceSearch::is_within(const Node& node) const {
    const double half = node.level == 0 ? 0.0 : 0.5 * cell_of(node.level);
    const Point2 middle = middle_of(node);
    const double x = std::max(0.0, std::fabs(middle.x - question_.center.x) - half);
    const double y = std::max(0.0, std::fabs(middle.y - question_.center.y) - half);
    return x * x + y * y <= question_.radius * question_.radius;
}

/// Returns whether all poses of a node are at the same place as the best one.
bool PlaceSearch::is_close(const Node& node) const {
    // The first and the last cell or turn of the finest level, relative to the best one.
    const auto ends = [&](std::int32_t at, std::int32_t best) {
        const std::int32_t first = (at << node.level) - best;
        return std::pair(first, first + (std::int32_t{1} << node.level) - 1);
    };
    const auto farthest = [&](std::int32_t at, std::int32_t best) {
        const auto [first, last] = ends(at, best);
        return static_cast<double>(std::max(std::abs(first), std::abs(last))) * SeenSpace::kCell;
    };
    const auto turned = [](std::int32_t turns) {
        const std::int32_t forth = (turns % kTurns + kTurns) % kTurns;
        return static_cast<double>(std::min(forth, kTurns - forth)) * turn_of(0);
    };
    const double x = farthest(node.column, best_node_.column);
    const double y = farthest(node.row, best_node_.row);
    const auto [first, last] = ends(node.turn, best_node_.turn);
    return x * x + y * y <= kApart * kApart && std::max(turned(first), turned(last)) <= kTurnApart;
}

} // namespace scanloom::scan_matching
