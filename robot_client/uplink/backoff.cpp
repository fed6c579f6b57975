#include "robot_client/uplink/backoff.hpp"

#include <algorithm>

namespace scanloom::robot {

std::chrono::milliseconds Backoff::next() {
    std::uniform_int_distribution<std::int64_t> part(wait_.count() / 2, wait_.count());
    const std::chrono::milliseconds chosen{part(random_)};
    wait_ = std::min(2 * wait_, waits_.longest);
    return chosen;
}

} // namespace scanloom::robot
