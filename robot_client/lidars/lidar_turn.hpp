#pragma once

#include <cstdint>
#include <vector>

/// What a spinning lidar measures.
namespace scanloom::robot {

struct LidarPoint {
    std::uint16_t distance = 0;  ///< millimetres; 0 = no measurement
    std::uint8_t confidence = 0; ///< the sensor's own scale

    friend bool operator==(const LidarPoint&, const LidarPoint&) = default;
};

struct LidarBeam {
    std::int32_t step = 0; ///< clockwise from ahead, from 0 to one less than a turn has; the driver says how many
    LidarPoint point;

    friend bool operator==(const LidarBeam&, const LidarBeam&) = default;
};

/// The points from one crossing of 0 degrees to the next.
struct LidarTurn {
    double stamp = 0.0;           ///< seconds, of its middle
    std::vector<LidarBeam> beams; ///< at least 1, with increasing steps
    double duration = 0.0;        ///< seconds from the first beam to the last; 0: not known

    friend bool operator==(const LidarTurn&, const LidarTurn&) = default;
};

} // namespace scanloom::robot
