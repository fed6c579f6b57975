#include "core/scan_matching/place_search.hpp"

#include "core/scan_matching/seen_space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <tuple>

namespace scanloom::scan_matching {
namespace {

constexpr double kCell = SeenSpace::kCell;
constexpr double kFacingTolerance = 0.5; // radians between the normals of a point and a surface
constexpr int kDirections = 8;           // that surfaces face

std::int32_t floor_of(double value) { return static_cast<std::int32_t>(std::floor(value)); }

/// Returns the bits of the directions within `tolerance` of an angle, radians; all for a point without a normal.
std::uint16_t facing(const SurfacePoint& point, double angle, double tolerance) {
    if (!point.has_normal()) return (1U << kDirections) - 1;
    constexpr double kWidth = 2.0 * std::numbers::pi / kDirections;
    unsigned bits = 0;
    const auto first = floor_of((angle - tolerance) / kWidth);
    const auto last = floor_of((angle + tolerance) / kWidth);
    for (auto n = first; n <= last; ++n) bits |= 1U << static_cast<unsigned>(n & (kDirections - 1));
    return static_cast<std::uint16_t>(bits);
}

double direction_of(const SurfacePoint& point) {
    return angle_of(static_cast<double>(point.normal_y), static_cast<double>(point.normal_x));
}

} // namespace

PlaceSearch::PlaceSearch(std::span<const View> views) {
    const SeenSpace space(views);
    corner_ = space.corner();
    cells_ = {static_cast<std::int32_t>(space.width()), static_cast<std::int32_t>(space.height()), {}};
    cells_.cells.reserve(static_cast<std::size_t>(space.width() * space.height()));
    for (std::int32_t row = 0; row < cells_.height; ++row) {
        for (std::int32_t column = 0; column < cells_.width; ++column) {
            const double x = corner_.x + (static_cast<double>(column) + 0.5) * kCell;
            const double y = corner_.y + (static_cast<double>(row) + 0.5) * kCell;
            cells_.cells.push_back(space.is_free(x, y) ? kPassed : kOpen);
        }
    }
    for (const View& view : views) {
        for (const SurfacePoint& point : view.points) {
            const SurfacePoint moved = transform(view.T_map_robot, point);
            const Bits bits = facing(moved, direction_of(moved), kFacingTolerance);
            const Point2 at = view.T_map_robot * Point2{point.x, point.y};
            const std::int32_t column = floor_of((at.x - corner_.x) / kCell);
            const std::int32_t row = floor_of((at.y - corner_.y) / kCell);
            for (std::int32_t j = row - 1; j <= row + 1; ++j) { // the space has a margin around all points
                for (std::int32_t i = column - 1; i <= column + 1; ++i) {
                    Bits& cell = cells_.cells[cells_.index_of(i, j)];
                    cell = static_cast<Bits>((cell | bits | kOpen) & ~kPassed);
                }
            }
        }
    }
    Level level = cells_;
    for (int n = 1; n < kLevels; ++n) {
        level = merged(level, 2, 2, 2);
        Squares& squares = bounds_.emplace_back();
        for (std::int32_t k = 0; k < 4; ++k) {
            squares[static_cast<std::size_t>(k)] = merged(level, 1, 2 + k % 2, 2 + k / 2);
        }
    }
}

/// Merges rectangles of cells, at every `step`-th cell. The first one ends at the first cell if they overlap.
PlaceSearch::Level PlaceSearch::merged(const Level& level, std::int32_t step, std::int32_t columns, std::int32_t rows) {
    const auto size_of = [&](std::int32_t size, std::int32_t count) { return (size + count - 1) / step; };
    const auto along = [&](std::int32_t size, std::int32_t count, std::int32_t lines, auto cell) {
        const std::int32_t before = count - step; // cells before the first one
        std::vector<Bits> result;
        for (std::int32_t line = 0; line < lines; ++line) {
            for (std::int32_t n = 0; n < size_of(size, count); ++n) {
                Bits bits = 0;
                for (std::int32_t k = 0; k < count; ++k) bits |= cell(n * step - before + k, line);
                result.push_back(bits);
            }
        }
        return result;
    };
    // By rows, then by columns; the first pass keeps its result by rows.
    const Level wide{size_of(level.width, columns), level.height,
                     along(level.width, columns, level.height, [&](auto i, auto j) { return level.at(i, j); })};
    const Level turned{size_of(level.height, rows), wide.width,
                       along(level.height, rows, wide.width, [&](auto j, auto i) { return wide.at(i, j); })};
    Level result{turned.height, turned.width, {}};
    result.cells.reserve(turned.cells.size());
    for (std::int32_t row = 0; row < result.height; ++row) {
        for (std::int32_t column = 0; column < result.width; ++column) result.cells.push_back(turned.at(row, column));
    }
    return result;
}

int PlaceSearch::score_of(std::span<const SurfacePoint> points, const Transform2& T_map_points) const {
    int score = 0;
    for (const SurfacePoint& point : points) {
        if (point.x * point.x + point.y * point.y > kReach * kReach) continue;
        const SurfacePoint moved = transform(T_map_points, point);
        const Bits bits = cells_.at(floor_of((moved.x - corner_.x) / kCell), floor_of((moved.y - corner_.y) / kCell));
        score += (bits & facing(moved, direction_of(moved), 0.0)) != 0 ? 1 : (bits & kOpen) != 0 ? 0 : -1;
    }
    return score;
}

/// One search.
class PlaceSearch::Search {
public:
    Search(const PlaceSearch& map, std::span<const SurfacePoint> points, const PlaceQuestion& question)
        : map_(map), question_(question), left_(question.lookups_max), least_(question.score_min) {
        for (const SurfacePoint& point : points) {
            const Point2 at{point.x, point.y};
            if (at.x * at.x + at.y * at.y > kReach * kReach) continue;
            points_.push_back({at, direction_of(point), std::sqrt(at.x * at.x + at.y * at.y), point});
        }
    }

    [[nodiscard]] std::optional<FoundPlace> run() {
        push_roots();
        while (!open_.empty()) {
            const Node node = open_.top();
            if (node.bound < least_) break;
            open_.pop();
            if (best_ && is_close(node)) continue;
            if (node.level > 0) {
                if (left_ < 8 * points_.size()) return std::nullopt;
                push_children(node);
            } else if (best_) {
                best_->rival_score = node.bound;
                return best_;
            } else {
                best_ = {pose_of(node), node.bound, 0};
                best_node_ = node;
                least_ = std::max(least_, static_cast<int>(question_.rival_share * node.bound) + 1);
            }
        }
        if (best_) best_->rival_score = least_ - 1;
        return best_;
    }

private:
    /// The poses in a cell of a level, and a bound of their scores.
    struct Node {
        int bound = 0;
        int level = 0;
        std::int32_t column = 0; // cell of the origin of the points
        std::int32_t row = 0;
        std::int32_t turn = 0;
    };

    /// Of equal bounds, the finer node comes first, then the one of the first place.
    struct IsWorse {
        bool operator()(const Node& a, const Node& b) const {
            return std::tuple(a.bound, -a.level, -a.turn, -a.row, -a.column) <
                   std::tuple(b.bound, -b.level, -b.turn, -b.row, -b.column);
        }
    };

    struct Point {
        Point2 at;
        double direction; // radians
        double distance;  // metres, from the origin
        SurfacePoint surface;
    };

    /// Where a point may be in an interval of rotations, if the origin is in the first cell.
    struct Rotated {
        std::int32_t column; // the last cell that it touches
        std::int32_t row;
        Bits facing;
        std::uint8_t square; // index in Squares
    };

    static constexpr int kFractionBits = 10;
    static constexpr std::int32_t kFraction = 1 << kFractionBits; // of a cell

    static double cell_of(int level) { return kCell * static_cast<double>(std::int32_t{1} << level); }
    static double turn_of(int level) { return 2.0 * std::numbers::pi / static_cast<double>(kTurns >> level); }
    static double angle_of_turn(int level, std::int32_t turn) {
        return (static_cast<double>(turn) + 0.5) * turn_of(level) - std::numbers::pi;
    }

    void push_roots() {
        constexpr int kTop = kLevels - 1;
        const Level& top = map_.bounds_.back().front();
        for (std::int32_t turn = 0; turn < kTurns >> kTop; ++turn) {
            rotate(kTop, turn);
            for (std::int32_t row = 0; row < top.height; ++row) {
                for (std::int32_t column = 0; column < top.width; ++column) push({0, kTop, column, row, turn});
            }
        }
    }

    void push_children(const Node& node) {
        for (std::int32_t k = 0; k < 2; ++k) {
            rotate(node.level - 1, 2 * node.turn + k);
            for (std::int32_t j = 0; j < 2; ++j) {
                for (std::int32_t i = 0; i < 2; ++i) {
                    push({0, node.level - 1, 2 * node.column + i, 2 * node.row + j, 2 * node.turn + k});
                }
            }
        }
    }

    void rotate(int level, std::int32_t turn) {
        const double angle = angle_of_turn(level, turn);
        const SinCos rotation = sin_cos(angle);
        const double scale = kFraction / cell_of(level);
        const double tolerance = level == 0 ? 0.0 : 0.5 * turn_of(level);
        rotated_.clear();
        for (const auto& [at, direction, distance, surface] : points_) {
            const std::int32_t x = floor_of((rotation.cos * at.x - rotation.sin * at.y) * scale);
            const std::int32_t y = floor_of((rotation.sin * at.x + rotation.cos * at.y) * scale);
            const Bits bits = facing(surface, direction + angle, tolerance);
            if (level == 0) { // one pose, with the origin in the middle of the cell
                rotated_.push_back(
                    {(x + kFraction / 2) >> kFractionBits, (y + kFraction / 2) >> kFractionBits, bits, 0});
                continue;
            }
            // The origin is anywhere in the cell, and the rotation moves the point by up to `shift`.
            const std::int32_t shift = floor_of(distance * tolerance * scale) + 2;
            const std::int32_t column = (x + kFraction + shift) >> kFractionBits;
            const std::int32_t row = (y + kFraction + shift) >> kFractionBits;
            const bool is_wide = column - ((x - shift) >> kFractionBits) > 1;
            const bool is_high = row - ((y - shift) >> kFractionBits) > 1;
            rotated_.push_back({column, row, bits, static_cast<std::uint8_t>((is_wide ? 1 : 0) + (is_high ? 2 : 0))});
        }
    }

    /// Adds a node, with the points as rotate() has turned them, unless its bound is too low.
    void push(Node node) {
        const bool is_pose = node.level == 0;
        const Level* grids = is_pose ? &map_.cells_ : map_.bounds_[static_cast<std::size_t>(node.level - 1)].data();
        if ((grids->at(node.column, node.row) & kPassed) == 0 || !is_within(node)) return;
        int bound = static_cast<int>(rotated_.size()); // if all others match
        std::size_t n = 0;
        while (n < rotated_.size() && bound >= least_) {
            const Rotated& point = rotated_[n++];
            const Bits bits = grids[point.square].at(point.column + node.column, point.row + node.row);
            if ((bits & point.facing) == 0) bound -= (bits & kOpen) != 0 ? 1 : 2;
        }
        left_ -= std::min(left_, n);
        node.bound = bound;
        if (bound >= least_) open_.push(node);
    }

    [[nodiscard]] Point2 middle_of(const Node& node) const {
        const double cell = cell_of(node.level);
        return {map_.corner_.x + (static_cast<double>(node.column) + 0.5) * cell,
                map_.corner_.y + (static_cast<double>(node.row) + 0.5) * cell};
    }

    [[nodiscard]] Transform2 pose_of(const Node& node) const {
        const auto [x, y] = middle_of(node);
        return {x, y, sin_cos(angle_of_turn(node.level, node.turn))};
    }

    /// Returns whether poses of a node may be in the circle of the question; at the finest level, whether its one is.
    [[nodiscard]] bool is_within(const Node& node) const {
        const double half = node.level == 0 ? 0.0 : 0.5 * cell_of(node.level);
        const Point2 middle = middle_of(node);
        const double x = std::max(0.0, std::fabs(middle.x - question_.center.x) - half);
        const double y = std::max(0.0, std::fabs(middle.y - question_.center.y) - half);
        return x * x + y * y <= question_.radius * question_.radius;
    }

    /// Returns whether all poses of a node are at the same place as the best one.
    [[nodiscard]] bool is_close(const Node& node) const {
        // The first and the last cell or turn of the finest level, relative to the best one.
        const auto ends = [&](std::int32_t at, std::int32_t best) {
            const std::int32_t first = (at << node.level) - best;
            return std::pair(first, first + (std::int32_t{1} << node.level) - 1);
        };
        const auto farthest = [&](std::int32_t at, std::int32_t best) {
            const auto [first, last] = ends(at, best);
            return static_cast<double>(std::max(std::abs(first), std::abs(last))) * kCell;
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

    const PlaceSearch& map_;
    const PlaceQuestion& question_;
    std::size_t left_; // lookups
    int least_;        // bound of nodes that matter
    std::vector<Point> points_;
    std::vector<Rotated> rotated_;
    std::priority_queue<Node, std::vector<Node>, IsWorse> open_;
    std::optional<FoundPlace> best_;
    Node best_node_;
};

std::optional<FoundPlace> PlaceSearch::find(std::span<const SurfacePoint> points, const PlaceQuestion& question) const {
    return Search(*this, points, question).run();
}

} // namespace scanloom::scan_matching
