#include "common/scan/scan_filter.hpp"

namespace scanloom {

ScanUse ScanFilter::use_of(Revision revision, const ScanPose& scan) const noexcept {
    if (exclusions_->cover(revision, scan)) return ScanUse::kExcluded;
    return jumps_.integrates(scan.robot, {scan.pose.x, scan.pose.y}) ? ScanUse::kIntegrated : ScanUse::kJump;
}

ScanUse ScanFilter::take(Revision revision, const ScanPose& scan) {
    const ScanUse use = use_of(revision, scan);
    if (use != ScanUse::kExcluded) jumps_.take(scan.robot, {scan.pose.x, scan.pose.y});
    return use;
}

} // namespace scanloom
