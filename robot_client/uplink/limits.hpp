#pragma once

/// Limits of a link's options, for the program and the client library.
namespace scanloom::robot {

inline constexpr double kMebibyte = 1024.0 * 1024.0;
inline constexpr double kSpoolMibMin = 1.0; ///< Spool::kBytesMin
inline constexpr double kSpoolMibMax = 1e6;
inline constexpr double kMemoryMibMin = 0.1;
inline constexpr double kMemoryMibMax = 1e5;
inline constexpr double kBatchDelayMax = 60.0;   ///< seconds
inline constexpr double kCellSizeMin = 0.01;     ///< metres
inline constexpr double kCellSizeMax = 1.0;      ///< metres
inline constexpr double kNearRadiusMin = 0.1;    ///< metres; no prior is more precise than this
inline constexpr double kNearRadiusMax = 1000.0; ///< metres

} // namespace scanloom::robot
