#pragma once

#include <chrono>

namespace scanloom::robot {

/// Converts a duration to seconds.
[[nodiscard]] inline double seconds(std::chrono::milliseconds duration) {
    return std::chrono::duration<double>(duration).count();
}

} // namespace scanloom::robot
