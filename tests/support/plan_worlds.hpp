#pragma once

#include "tests/support/class_map.hpp"

#include <algorithm>
#include <random>
#include <vector>

namespace scanloom::testing_support {

/// A box of free and occupied cells from (0, 0), set at random. The classes are computed from them.
class PlanWorld {
public:
    PlanWorld(std::int32_t width, std::int32_t height, OccType all)
        : width_(width), height_(height),
          types_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), all) {}

    [[nodiscard]] std::int32_t width() const { return width_; }
    [[nodiscard]] std::int32_t height() const { return height_; }
    [[nodiscard]] OccType at(Cell cell) const { return types_[index_of(cell)]; }

    /// Fills the part of the rectangle that is within the box.
    void fill(std::int32_t i, std::int32_t j, std::int32_t width, std::int32_t height, OccType type) {
        for (std::int32_t y = std::max(j, 0); y < std::min(j + height, height_); ++y) {
            for (std::int32_t x = std::max(i, 0); x < std::min(i + width, width_); ++x) types_[index_of({x, y})] = type;
        }
    }

    void frame(std::int32_t thickness) {
        fill(0, 0, width_, thickness, OccType::kOccupied);
        fill(0, height_ - thickness, width_, thickness, OccType::kOccupied);
        fill(0, 0, thickness, height_, OccType::kOccupied);
        fill(width_ - thickness, 0, thickness, height_, OccType::kOccupied);
    }

    [[nodiscard]] ClassView view(std::int32_t danger_cells = 3) const {
        return classified({0, 0, width_, height_}, danger_cells, [this](Cell cell) { return at(cell); });
    }

private:
    [[nodiscard]] std::size_t index_of(Cell cell) const {
        return static_cast<std::size_t>(cell.j) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(cell.i);
    }

    std::int32_t width_;
    std::int32_t height_;
    std::vector<OccType> types_;
};

/// Rooms on both sides of corridors, each with a door and some furniture. At 0.05 m: rooms of 4 x 4 m, corridors 2 m
/// wide, doors of 1 m.
[[nodiscard]] inline PlanWorld office(std::int32_t width, std::int32_t height, unsigned seed) {
    constexpr std::int32_t kRoom = 80;
    constexpr std::int32_t kCorridor = 40;
    constexpr std::int32_t kDoor = 20;
    constexpr std::int32_t kWall = 3;
    std::mt19937 random(seed);
    PlanWorld world(width, height, OccType::kFree);
    world.frame(kWall);
    for (std::int32_t j = 0; j < height; j += kRoom + kCorridor) {
        world.fill(0, j + kRoom, width, kWall, OccType::kOccupied); // the corridor is above
        world.fill(0, j + kRoom + kCorridor, width, kWall, OccType::kOccupied);
        for (std::int32_t i = 0; i < width; i += kRoom) {
            world.fill(i, j, kWall, kRoom, OccType::kOccupied);
            const std::int32_t door = i + 10 + random_below(random, kRoom - 20 - kDoor);
            world.fill(door, j + kRoom, kDoor, kWall, OccType::kFree);
            if (random() % 3 == 0) world.fill(door, j, kDoor, kWall, OccType::kFree);
            for (int piece = 0; piece < 4; ++piece) {
                world.fill(i + 8 + random_below(random, kRoom - 30), j + 8 + random_below(random, kRoom - 30),
                           2 + random_below(random, 14), 2 + random_below(random, 14), OccType::kOccupied);
            }
        }
    }
    world.frame(kWall);
    return world;
}

/// Returns a maze with exactly one path between any two of its squares, which are `pitch` cells apart. Walls are one
/// cell thick.
[[nodiscard]] inline PlanWorld maze(std::int32_t width, std::int32_t height, std::int32_t pitch, unsigned seed) {
    std::mt19937 random(seed);
    PlanWorld world(width, height, OccType::kFree);
    const std::int32_t columns = width / pitch;
    const std::int32_t rows = height / pitch;
    for (std::int32_t c = 0; c <= columns; ++c) world.fill(c * pitch, 0, 1, height, OccType::kOccupied);
    for (std::int32_t r = 0; r <= rows; ++r) world.fill(0, r * pitch, width, 1, OccType::kOccupied);
    std::vector<bool> seen(static_cast<std::size_t>(columns * rows));
    std::vector<Cell> path = {{0, 0}};
    seen[0] = true;
    while (!path.empty()) { // to a square not visited yet, or back
        const Cell at = path.back();
        std::vector<Cell> unseen;
        for (const Cell step : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
            const Cell next{at.i + step.i, at.j + step.j};
            if (next.i < 0 || next.j < 0 || next.i >= columns || next.j >= rows) continue;
            if (!seen[static_cast<std::size_t>(next.j * columns + next.i)]) unseen.push_back(next);
        }
        if (unseen.empty()) {
            path.pop_back();
            continue;
        }
        const Cell next = unseen[random() % unseen.size()];
        seen[static_cast<std::size_t>(next.j * columns + next.i)] = true;
        if (next.i != at.i) {
            world.fill(std::max(at.i, next.i) * pitch, at.j * pitch + 1, 1, pitch - 1, OccType::kFree);
        } else {
            world.fill(at.i * pitch + 1, std::max(at.j, next.j) * pitch, pitch - 1, 1, OccType::kFree);
        }
        path.push_back(next);
    }
    world.frame(1);
    return world;
}

} // namespace scanloom::testing_support
