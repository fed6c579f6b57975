#pragma once

#include <chrono>

namespace scanloom::robot {

/// `duration` as a number of seconds.
[[nodiscard]] inline double seconds(std::chrono::milliseconds duration) {
    return std::chrono::duration<double>(duration).count();
}

} // namespace scanloom::robot
