#include "robot_client/ros/scan_place.hpp"

#include "common/scan/limits.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace scanloom::robot {
namespace {

std::string_view text_of(NoTransform reason) {
    switch (reason) {
    case NoTransform::kNotConnected: return "no transforms to its frame";
    case NoTransform::kBefore: return "before the first pose";
    case NoTransform::kAfter: return "after the last pose";
    case NoTransform::kHole: return "in a hole of the poses";
    case NoTransform::kLoop: return "a loop of frames in the transforms";
    }
    return {};
}

NoPlace no_place(NoTransform reason) {
    return {std::string(text_of(reason)), reason == NoTransform::kAfter || reason == NoTransform::kNotConnected};
}

} // namespace

std::variant<ScanPlace, NoPlace> place_of_scan(const FrameTree& tree, const FrameChoice& frames,
                                               const FoundLaser& laser, const std::string& frame, EpochTime middle) {
    ScanPlace place;
    if (frames.poses != Poses::kNone) {
        const auto found = tree.find(frames.fixed, frames.base, middle);
        if (const auto* reason = std::get_if<NoTransform>(&found)) return no_place(*reason);
        place.pose = planar(std::get<Eigen::Isometry3d>(found));
        if (std::max(std::fabs(place.pose.x), std::fabs(place.pose.y)) > kCoordinateMax) return NoPlace{"too far away"};
    }
    if (laser.is_connected) {
        const auto found = tree.find(frames.base, frame, middle);
        const auto* reason = std::get_if<NoTransform>(&found);
        if (reason != nullptr && !laser.mount) {
            auto none = no_place(*reason);
            none.is_mount = true;
            return none;
        }
        const Result<LaserMount> mount =
            reason != nullptr ? LaserMount{} : mount_of(std::get<Eigen::Isometry3d>(found));
        if (!mount && !laser.mount) return NoPlace{mount.error().message};
        if (mount) place.mount = *mount;
    }
    if (laser.mount) place.mount.T_robot_laser = *laser.mount; // whether it is upside down, only transforms say
    return place;
}

} // namespace scanloom::robot
