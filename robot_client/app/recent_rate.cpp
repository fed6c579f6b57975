#include "robot_client/app/recent_rate.hpp"

namespace scanloom::robot {

double RecentRate::update(std::chrono::duration<double> now, std::uint64_t count) {
    samples_.push_back({now, count});
    while (samples_.size() > 1 && now - samples_[1].at >= kWindow) samples_.pop_front();
    const Sample& first = samples_.front();
    const double passed = (now - first.at).count();
    return passed > 0.0 && count > first.count ? static_cast<double>(count - first.count) / passed : 0.0;
}

} // namespace scanloom::robot
