#include "core/localization/session_poses.hpp"

#include <algorithm>
#include <cstddef>

/// Whether members that were read fit together; as in core/slam.
namespace scanloom::localization {
namespace {

/// Returns whether the scans that were decided at a correction are on keyframes that it has.
/// @param checked  number of scans that an earlier correction had; set to those of this one
bool has_keyframes_of(const slam::TrajectoryEstimator& estimator, const RobotHistory::Moment& moment,
                      const GraphMoment& graph, std::size_t& checked) {
    if (moment.decided > estimator.decided_count()) return false;
    for (; checked < moment.decided; ++checked) {
        if (estimator.placement(checked).keyframe >= graph.keyframes.size()) return false;
    }
    return true;
}

} // namespace

bool RobotPoses::is_consistent(const std::vector<std::shared_ptr<const GraphMoment>>& corrections) const {
    if (!estimator_.is_consistent() || laser_scans_.size() != estimator_.scan_count()) return false;
    const auto is_scan = [&](std::size_t scan) { return scan < scans_.size(); };
    const auto is_laser_scan = [&](std::size_t scan) {
        return scan == kNoLaserScan || scan == kExcluded || scan < laser_scans_.size();
    };
    if (!std::ranges::all_of(laser_scans_, is_scan)) return false;
    if (!std::ranges::all_of(scans_, is_laser_scan, &ScanAnchor::laser_scan)) return false;
    if (in_maps_.snapshot().size() != scans_.size() || decided_ > estimator_.decided_count()) return false;
    if (keyframes_in_maps_.size() != estimator_.keyframes().size()) return false;
    if (corrections_.size() > corrections.size()) return false;
    std::size_t checked = 0;
    for (std::size_t n = 0; n < corrections_.size(); ++n) {
        const GraphMoment& graph = *corrections[corrections.size() - corrections_.size() + n];
        if (corrections_[n].scans > scans_.size()) return false;
        if (!has_keyframes_of(estimator_, corrections_[n], graph, checked)) return false;
    }
    return true;
}

bool SessionPoses::is_consistent() const {
    std::size_t scans = 0;
    std::size_t keyframes = 0; // of the graph at a correction; it only grows
    for (const auto& moment : corrections_) {
        if (moment->keyframes.size() < keyframes || moment->is_located.size() != moment->keyframes.size()) return false;
        keyframes = moment->keyframes.size();
    }
    if (!map_->is_consistent() || keyframes > map_->graph().size()) return false;
    for (const auto& robot : robots_) {
        if (!robot) continue;
        if (!robot->is_consistent(corrections_)) return false;
        scans += robot->estimated_count();
    }
    return scans == scan_count_;
}

} // namespace scanloom::localization
