#include "robot_client/sim/map_world.hpp"

#include "robot_client/sim/cell_shapes.hpp"
#include "robot_client/sim/start_cells.hpp"
#include "robot_client/sim/unicycle.hpp"

#include <fmt/format.h>

namespace scanloom::robot {
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
