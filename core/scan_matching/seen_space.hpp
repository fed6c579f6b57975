#pragma once

#include "core/scan_matching/point_map.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::scan_matching {

/// Where beams of some views passed, and where they ended, in cells of 10 cm. A point that another scan has in space
/// that beams passed contradicts these views. Immutable.
/// Source: own; the beams are drawn as in an occupancy grid, Moravec, Elfes (1985).
/// Precondition: poses and points are finite, and within 1 km of each other. Memory: 100 bytes for each square metre of
///     the rectangle around all points.
/// Threads: any number of readers.
class SeenSpace {
public:
    static constexpr double kCell = 0.1; ///< metres

    SeenSpace() = default;

    /// Draws the beams of the views. The last 15 cm before a point count as its surface.
    explicit SeenSpace(std::span<const View> views);

    /// Returns whether beams passed the place, and no point is in its cell or a neighbouring one.
    /// @param x  metres, in the frame of the views' poses
    /// @param y  metres
    [[nodiscard]] bool is_free(double x, double y) const noexcept { return at(x, y) == kPassed; }

    /// Returns whether a point is in the cell of the place or in a neighbouring one.
    [[nodiscard]] bool is_near_point(double x, double y) const noexcept { return (at(x, y) & kNearPoint) != 0; }

    /// Returns whether a point is in the cell of the place.
    [[nodiscard]] bool has_point(double x, double y) const noexcept { return (at(x, y) & kPoint) != 0; }

    /// Returns whether a beam passes the cell of a point more than 30 cm before its end.
    /// @param laser  metres, where the beam starts
    /// @param end    metres, where it ends
    [[nodiscard]] bool meets_point(const Point2& laser, const Point2& end) const noexcept;

    /// Returns the lower left corner of the grid, metres, in the frame of the views' poses.
    [[nodiscard]] Point2 corner() const noexcept { return {x_, y_}; }
    /// Returns the number of columns of the grid.
    [[nodiscard]] std::int64_t width() const noexcept { return width_; }
    /// Returns the number of rows of the grid.
    [[nodiscard]] std::int64_t height() const noexcept { return height_; }

    /// Returns whether there are no views with points.
    [[nodiscard]] bool is_empty() const noexcept { return cells_.empty(); }

private:
    enum Bits : std::uint8_t { kPassed = 1, kPoint = 2, kNearPoint = 4 };

    [[nodiscard]] std::uint8_t at(double x, double y) const noexcept {
        const double column = (x - x_) * (1.0 / kCell);
        const double row = (y - y_) * (1.0 / kCell);
        // Compared before the conversion, which is undefined for values that do not fit. False for NaN.
        const bool is_inside =
            column >= 0.0 && row >= 0.0 && column < static_cast<double>(width_) && row < static_cast<double>(height_);
        if (!is_inside) return 0;
        return cells_[static_cast<std::size_t>(static_cast<std::int64_t>(row) * width_ +
                                               static_cast<std::int64_t>(column))];
    }

    void draw_beams(const View& view);

    double x_ = 0.0; // metres, lower left corner
    double y_ = 0.0;
    std::int64_t width_ = 0; // cells
    std::int64_t height_ = 0;
    std::vector<std::uint8_t> cells_; // Bits, by rows
};

} // namespace scanloom::scan_matching
