#pragma once

namespace scanloom::lab {

/// The smallest and the largest value.
struct ValueRange {
    double low = 0.0;
    double high = 0.0;
};

/// Published values for the landmarks of a real room, for orientation: both the room and the lidar were others.
inline constexpr ValueRange kPublishedPersistence{0.18, 0.49};
inline constexpr ValueRange kPublishedStability{0.67, 0.89};
inline constexpr ValueRange kPublishedContinuity{0.43, 0.46};

inline constexpr double kPublishedTolerance = 0.1;      ///< metres, for the two values below
inline constexpr double kPublishedDistanceMean = 0.018; ///< metres
inline constexpr double kPublishedDistanceSigma = 0.013;

} // namespace scanloom::lab
