#include "sim/map_world.hpp"

#include "sim/shapes.hpp"
#include "sim/unicycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scanloom::robot {
namespace {

/// A number of cells; saturates.
using Steps = std::uint16_t;

/// Returns each cell's Chebyshev distance to the nearest occupied cell; no other metric gives more. Uses two passes:
/// the nearest occupied cell lies before a cell or behind it.
std::vector<Steps> steps_to_solids(const MapCells& map) {
    constexpr int kFarthest = std::numeric_limits<Steps>::max();
    const auto width = static_cast<std::ptrdiff_t>(map.width);
    const auto height = static_cast<std::ptrdiff_t>(map.height());
    const auto index = [&](std::ptrdiff_t i, std::ptrdiff_t j) { return static_cast<std::size_t>(j * width + i); };
    std::vector<Steps> steps(map.cells.size());
    for (std::size_t n = 0; n < steps.size(); ++n) steps[n] = map.cells[n] == MapCell::kOccupied ? 0 : kFarthest;
    const auto look = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t back) {
        int nearest = steps[index(i, j)];
        const auto come_from = [&](std::ptrdiff_t from_i, std::ptrdiff_t from_j) {
            if (from_i < 0 || from_i >= width || from_j < 0 || from_j >= height) return;
            nearest = std::min(nearest, steps[index(from_i, from_j)] + 1);
        };
        come_from(i + back, j);
        for (const std::ptrdiff_t aside : {-1, 0, 1}) come_from(i + aside, j + back);
        steps[index(i, j)] = static_cast<Steps>(nearest);
    };
    for (std::ptrdiff_t j = 0; j < height; ++j) {
        for (std::ptrdiff_t i = 0; i < width; ++i) look(i, j, -1);
    }
    for (std::ptrdiff_t j = height; j-- > 0;) {
        for (std::ptrdiff_t i = width; i-- > 0;) look(i, j, 1);
    }
    return steps;
}

/// Returns the number of cells at which every point of one cell is at least `metres` from every point of the other.
int steps_for(double metres, double resolution) { return static_cast<int>(std::ceil(metres / resolution - 1e-9)) + 1; }

/// Returns the open cells connected to one of them (four neighbours), and closes them.
std::vector<std::size_t> take_part(std::size_t seed, std::size_t width, std::vector<bool>& is_open) {
    std::vector<std::size_t> part;
    const auto reach = [&](std::size_t at) {
        if (!is_open[at]) return;
        is_open[at] = false;
        part.push_back(at);
    };
    reach(seed);
    for (std::size_t n = 0; n < part.size(); ++n) {
        const std::size_t at = part[n];
        if (at % width > 0) reach(at - 1);
        if (at % width + 1 < width) reach(at + 1);
        if (at >= width) reach(at - width);
        if (at + width < is_open.size()) reach(at + width);
    }
    return part;
}

} // namespace

std::vector<std::size_t> start_cells(const MapCells& map, double resolution, double clearance_m, double passage_m) {
    const auto steps = steps_to_solids(map);
    const int wanted = steps_for(clearance_m, resolution);
    const int passable = steps_for(passage_m, resolution);
    std::vector<bool> is_open(map.cells.size());
    for (std::size_t n = 0; n < map.cells.size(); ++n) {
        is_open[n] = map.cells[n] == MapCell::kFree && steps[n] >= passable;
    }
    std::vector<std::size_t> best;
    for (std::size_t seed = 0; seed < map.cells.size(); ++seed) {
        if (!is_open[seed]) continue;
        auto part = take_part(seed, map.width, is_open);
        std::erase_if(part, [&](std::size_t at) { return steps[at] < wanted; });
        if (part.size() > best.size()) best = std::move(part);
    }
    std::ranges::sort(best);
    return best;
}

namespace {

constexpr double kTightStart = 0.3;             // metres, of clearance
constexpr double kPassage = kBodyRadius + 0.05; // metres around the robot's centre
constexpr std::size_t kStartsMax = 10'000;

/// Sets the starts where there is room.
/// @return whether there are any
bool find_starts(World& world, const MapCells& cells, const MapFrame& frame) {
    for (const double clearance : {kStartClearance, kTightStart}) {
        const auto starts = start_cells(cells, frame.resolution, clearance, kPassage);
        const std::size_t stride = starts.size() / kStartsMax + 1; // of a large map, only some
        for (std::size_t n = 0; n < starts.size(); n += stride) {
            const std::size_t column = starts[n] % cells.width;
            const std::size_t row = starts[n] / cells.width;
            world.starts.push_back({frame.x(column), frame.y(row), frame.x(column + 1), frame.y(row + 1)});
        }
        world.start_clearance = clearance - 1e-6; // allows for rounding of the cells' borders
        if (!world.starts.empty()) return true;
    }
    return false;
}

} // namespace

Result<World> world_of_map(std::string name, const RosMapDescription& map, const MapCells& cells) {
    const MapFrame frame{map.resolution, map.origin_x, map.origin_y};
    World world;
    world.name = std::move(name);
    if (!find_starts(world, cells, frame)) {
        return Error{Errc::kInvalidField,
                     fmt::format("the map has no free place with a clearance of {} m, which a robot needs as its start",
                                 kTightStart)};
    }
    world.solids = boxes_of(cells, MapCell::kOccupied, frame);
    world.floors = boxes_of(cells, MapCell::kFree, frame);
    world.unknown = boxes_of(cells, MapCell::kUnknown, frame);
    world.outlines = outlines_of(cells, frame);
    world.obstacles = std::make_shared<const Obstacles>(world.outlines, world.solids);
    return world;
}

} // namespace scanloom::robot
