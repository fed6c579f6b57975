#include "sim/map_world.hpp"

#include "core/planning/bit_grid.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace scanloom::sim {

using planning::BitGrid;
using planning::Spot;
namespace {

/// Returns the cells of one kind.
BitGrid cells_of(const MapCells& map, MapCell kind) {
    BitGrid cells(static_cast<std::int32_t>((map.width + 63) / 64 * 64), static_cast<std::int32_t>(map.height()));
    for (std::size_t n = 0; n < map.cells.size(); ++n) {
        if (map.cells[n] != kind) continue;
        cells.set({static_cast<std::int32_t>(n % map.width), static_cast<std::int32_t>(n / map.width)});
    }
    return cells;
}

/// Returns the cells that may be nearer than `cells` cells to a solid cell, measured between their nearest points. It
/// selects by the Chebyshev distance, up to `cells` rounded up: no other metric gives a smaller distance.
BitGrid cells_near(const BitGrid& solids, double cells) {
    const auto reach = static_cast<std::int32_t>(std::ceil(cells - 1e-9));
    return planning::dilated(solids, std::vector(static_cast<std::size_t>(reach) + 1, reach));
}

/// Returns the open cells connected to one of them (four neighbours), and closes them.
std::vector<Spot> take_part(Spot seed, BitGrid& open) {
    std::vector<Spot> part;
    const auto reach = [&](Spot at) {
        if (!open.test(at)) return;
        open.clear(at);
        part.push_back(at);
    };
    reach(seed);
    for (std::size_t n = 0; n < part.size(); ++n) {
        const Spot at = part[n];
        for (const Spot next : {Spot{at.x - 1, at.y}, {at.x + 1, at.y}, {at.x, at.y - 1}, {at.x, at.y + 1}})
            reach(next);
    }
    return part;
}

} // namespace

std::vector<std::size_t> start_cells(const MapCells& map, double resolution, double clearance_m, double passage_m) {
    const BitGrid solids = cells_of(map, MapCell::kOccupied);
    const BitGrid tight = cells_near(solids, clearance_m / resolution);
    BitGrid open = cells_of(map, MapCell::kFree);
    open.subtract(cells_near(solids, passage_m / resolution));
    std::vector<Spot> best;
    planning::for_each_set(BitGrid(open), [&](Spot seed) {
        auto part = take_part(seed, open);
        std::erase_if(part, [&](Spot at) { return tight.test(at); });
        if (part.size() > best.size()) best = std::move(part);
    });
    std::vector<std::size_t> starts;
    for (const Spot at : best) {
        starts.push_back(static_cast<std::size_t>(at.y) * map.width + static_cast<std::size_t>(at.x));
    }
    std::ranges::sort(starts);
    return starts;
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

} // namespace scanloom::sim
