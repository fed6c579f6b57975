#pragma once

#include <cstdint>

namespace scanloom {

/// How a laser scan is integrated into cells. server/mapping defines each model.
enum class RayModel : std::uint8_t {
    kInverseSensorModel, ///< every cell in the sector of a beam, by its distance and direction
    kBresenham,          ///< the cells of a straight line from the sensor's cell to the hit's
    kTraversal,          ///< every cell that the beam crosses
};

} // namespace scanloom
