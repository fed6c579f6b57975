#pragma once

#include "common/geometry/pose2.hpp"
#include "core/classify/cell_class.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <set>
#include <utility>
#include <vector>

/// Finds, by an exhaustive search, the frontiers that a robot left when it reported that exploration is complete.
/// Written from the documentation of exploration goals, without their code. Where the documentation permits several
/// results (which of equally near cells, how a slanted line is divided into cells), this uses the stricter one: every
/// implementation could have explored the frontiers that this finds.
namespace scanloom::testing_support {

class Unexplored {
public:
    using Place = std::pair<std::int32_t, std::int32_t>; ///< (j, i) of a cell

    struct Claim {
        double cell_size = 0.05;   ///< metres
        double clearance = 0.0;    ///< metres around the robot's centre
        double standoff = 1.0;     ///< metres over free ground, from where a frontier is observed
        std::size_t size_min = 1;  ///< cells, of a frontier that counts
        std::set<Place> looked_at; ///< cells that robots were sent to observe: excluded from now on
    };

    /// @param area  cells that contain the whole known area
    Unexplored(const classify::ClassView& classes, const grid::CellBox& area, Claim claim)
        : claim_(std::move(claim)), area_(area), width_(area.i_end - area.i_begin), height_(area.j_end - area.j_begin) {
        for (std::int32_t j = area.j_begin; j < area.j_end; ++j) {
            for (std::int32_t i = area.i_begin; i < area.i_end; ++i) cells_.push_back(class_at(classes, {i, j}));
        }
        find_fitting();
    }

    /// Returns the frontiers that a robot at this place could reach and observe, each by its first cell.
    [[nodiscard]] std::vector<grid::Cell> within_reach_of(const Point2& robot) const {
        const std::vector<bool> reached = flood_from(robot);
        std::vector<grid::Cell> left;
        for (const auto& frontier : frontiers()) {
            if (can_be_seen(frontier, reached)) {
                left.push_back({area_.i_begin + frontier[0].first, area_.j_begin + frontier[0].second});
            }
        }
        return left;
    }

    /// Counts the cells that the body's centre could reach.
    [[nodiscard]] std::int64_t reach(const Point2& robot) const {
        const auto reached = flood_from(robot);
        return std::count(reached.begin(), reached.end(), true);
    }

private:
    using At = std::pair<std::int32_t, std::int32_t>; // column, row of the area

    static constexpr std::array<At, 4> kStraight{At{1, 0}, At{-1, 0}, At{0, 1}, At{0, -1}};

    [[nodiscard]] bool holds(At at) const {
        return at.first >= 0 && at.second >= 0 && at.first < width_ && at.second < height_;
    }
    [[nodiscard]] std::size_t index(At at) const {
        return static_cast<std::size_t>(at.second) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(at.first);
    }
    [[nodiscard]] classify::CellClass of(At at) const {
        return holds(at) ? cells_[index(at)] : classify::CellClass::kUnexplored;
    }
    [[nodiscard]] bool is_ground(At at) const {
        const auto found = of(at);
        return found == classify::CellClass::kFree || found == classify::CellClass::kDanger;
    }

    /// Finds the cells where the body has only known free ground within the clearance plus a fifth of a cell, the most
    /// that the diagonal steps of paths may need.
    void find_fitting() {
        const double radius = claim_.clearance / claim_.cell_size + 0.2;
        const auto far = static_cast<std::int32_t>(std::ceil(radius + 0.5));
        std::vector<At> disc;
        for (std::int32_t dj = -far; dj <= far; ++dj) {
            for (std::int32_t di = -far; di <= far; ++di) {
                const double x = std::max(0.0, std::abs(di) - 0.5); // to the square of the cell
                const double y = std::max(0.0, std::abs(dj) - 0.5);
                if (x * x + y * y <= radius * radius) disc.emplace_back(di, dj);
            }
        }
        fits_.assign(cells_.size(), false);
        for (std::int32_t row = 0; row < height_; ++row) {
            for (std::int32_t column = 0; column < width_; ++column) {
                fits_[index({column, row})] = std::ranges::all_of(disc, [&](const At& offset) {
                    return is_ground({column + offset.first, row + offset.second});
                });
            }
        }
    }

    /// Spreads by straight steps over cells where the body fits, from all of them within the clearance plus one cell of
    /// the robot.
    [[nodiscard]] std::vector<bool> flood_from(const Point2& robot) const {
        std::vector<bool> reached(cells_.size(), false);
        std::deque<At> open;
        const auto reach = [&](At at) {
            if (!holds(at) || !fits_[index(at)] || reached[index(at)]) return;
            reached[index(at)] = true;
            open.push_back(at);
        };
        const double x = robot.x / claim_.cell_size - area_.i_begin;
        const double y = robot.y / claim_.cell_size - area_.j_begin;
        const double near = claim_.clearance / claim_.cell_size + 1.0;
        for (std::int32_t row = 0; row < height_; ++row) {
            for (std::int32_t column = 0; column < width_; ++column) {
                if (std::hypot(column + 0.5 - x, row + 0.5 - y) <= near) reach({column, row});
            }
        }
        while (!open.empty()) {
            const At at = open.front();
            open.pop_front();
            for (const At& step : kStraight) reach({at.first + step.first, at.second + step.second});
        }
        return reached;
    }

    /// Returns groups of 8-connected FRONTIER cells that count.
    [[nodiscard]] std::vector<std::vector<At>> frontiers() const {
        std::vector<bool> seen(cells_.size(), false);
        std::vector<std::vector<At>> found;
        const auto counts = [&](At at) {
            return of(at) == classify::CellClass::kFrontier && !seen[index(at)] &&
                   !claim_.looked_at.contains({area_.j_begin + at.second, area_.i_begin + at.first});
        };
        for (std::int32_t row = 0; row < height_; ++row) {
            for (std::int32_t column = 0; column < width_; ++column) {
                if (!counts({column, row})) continue;
                std::vector<At> group{{column, row}};
                seen[index({column, row})] = true;
                for (std::size_t n = 0; n < group.size(); ++n) {
                    for (int neighbour = 0; neighbour < 9; ++neighbour) {
                        const At at{group[n].first + neighbour % 3 - 1, group[n].second + neighbour / 3 - 1};
                        if (!counts(at)) continue;
                        seen[index(at)] = true;
                        group.push_back(at);
                    }
                }
                if (group.size() >= claim_.size_min) found.push_back(std::move(group));
            }
        }
        return found;
    }

    /// Returns whether a cell within the standoff, by straight steps over free ground, is reached and has a clear line
    /// to the group.
    [[nodiscard]] bool can_be_seen(const std::vector<At>& group, const std::vector<bool>& reached) const {
        std::vector<bool> known(cells_.size(), false);
        std::vector<At> ring;
        const auto add = [&](At at, std::vector<At>& to) {
            if (!is_ground(at) || known[index(at)]) return;
            known[index(at)] = true;
            to.push_back(at);
        };
        for (const At& cell : group) {
            for (int neighbour = 0; neighbour < 9; ++neighbour) {
                add({cell.first + neighbour % 3 - 1, cell.second + neighbour / 3 - 1}, ring);
            }
        }
        const auto rings = std::max(8, static_cast<int>(claim_.standoff / claim_.cell_size));
        for (int n = 0; n < rings && !ring.empty(); ++n) {
            for (const At& at : ring) {
                if (reached[index(at)] && sees_nearest(at, group)) return true;
            }
            std::vector<At> next;
            for (const At& at : ring) {
                for (const At& step : kStraight) add({at.first + step.first, at.second + step.second}, next);
            }
            ring = std::move(next);
        }
        return false;
    }

    [[nodiscard]] bool sees_nearest(At from, const std::vector<At>& group) const {
        const auto distance = [&](const At& cell) {
            return std::hypot(cell.first - from.first, cell.second - from.second);
        };
        double least = std::numeric_limits<double>::infinity();
        for (const At& cell : group) least = std::min(least, distance(cell));
        return std::ranges::all_of(
            group, [&](const At& cell) { return distance(cell) > least + 1e-9 || has_clear_line(from, cell); });
    }

    /// Returns whether the straight line between the centres neither crosses nor touches an occupied cell.
    [[nodiscard]] bool has_clear_line(At from, At to) const {
        constexpr double kTouching = 1e-6;
        const double length = std::hypot(to.first - from.first, to.second - from.second);
        const int steps = 1 + static_cast<int>(length * 16.0);
        for (int n = 0; n <= steps; ++n) {
            const double x = from.first + 0.5 + (to.first - from.first) * static_cast<double>(n) / steps;
            const double y = from.second + 0.5 + (to.second - from.second) * static_cast<double>(n) / steps;
            for (const double dx : {-kTouching, kTouching}) {
                for (const double dy : {-kTouching, kTouching}) {
                    const At at{static_cast<std::int32_t>(std::floor(x + dx)),
                                static_cast<std::int32_t>(std::floor(y + dy))};
                    if (of(at) == classify::CellClass::kOccupied) return false;
                }
            }
        }
        return true;
    }

    Claim claim_;
    grid::CellBox area_;
    std::int32_t width_;
    std::int32_t height_;
    std::vector<classify::CellClass> cells_; // row by row
    std::vector<bool> fits_;
};

} // namespace scanloom::testing_support
