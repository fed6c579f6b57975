#include "lab/door_room.hpp"

namespace scanloom::lab {
namespace {

constexpr double kWallSouth = -5.2; // metres; the eastern wall is 5.0 <= x <= 5.2
constexpr double kWallNorth = 5.2;
constexpr double kDoorSouth = 2.2;
constexpr double kDoorNorth = 3.2;

constexpr sim::Box kLeafClosed{5.08, kDoorSouth, 5.12, kDoorNorth};
constexpr sim::Box kLeafOpen{4.0, kDoorNorth, 5.0, kDoorNorth + 0.04};

} // namespace

sim::World make_door_room(Door door) {
    const sim::World room = sim::make_room();
    auto solids = room.solids;
    std::erase(solids, sim::Box{5.0, kWallSouth, 5.2, kWallNorth});
    solids.insert(solids.end(), {
                                    {5.0, kWallSouth, 5.2, kDoorSouth},
                                    {5.0, kDoorNorth, 5.2, kWallNorth},
                                    // the lobby's walls: south, north, east
                                    {5.2, 1.0, 7.4, 1.2},
                                    {5.2, 4.2, 7.4, 4.4},
                                    {7.2, 1.0, 7.4, 4.4},
                                });
    solids.push_back(door == Door::kClosed ? kLeafClosed : kLeafOpen);
    return sim::make_world("door_room", std::move(solids), room.floors);
}

} // namespace scanloom::lab
