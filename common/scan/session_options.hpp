#pragma once

#include <cstdint>
#include <optional>

namespace scanloom {

/// The layer that decides which cells are free and which are occupied.
enum class ClassSource : std::uint8_t { kOccupancy, kHimm };

/// How a laser scan is integrated into cells. core/mapping defines each model.
enum class RayModel : std::uint8_t {
    kInverseSensorModel, ///< every cell in the sector of a beam, by its distance and direction
    kBresenham,          ///< the cells of a straight line from the sensor's cell to the hit's
    kTraversal,          ///< every cell that the beam crosses
};

/// The requested settings of a session's maps; an absent setting takes its default. settings.def documents each.
struct SessionOptions {
#define SCANLOOM_SETTING(type, name, ...) std::optional<type> name;
#include "common/scan/settings.def"

    friend bool operator==(const SessionOptions&, const SessionOptions&) = default;
};

} // namespace scanloom
