#include "server/landmarks/session_captures.hpp"

#include <variant>

namespace scanloom::landmarks {

std::optional<RobotCapture> SessionCaptures::add(const LogEntry& entry) {
    ++revision_;
    if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
        sensors_.insert_or_assign({described->robot, described->sensor.id}, described->sensor);
    }
    const auto* taken = std::get_if<ScanTaken>(&entry);
    if (taken == nullptr) return std::nullopt;
    if (filter_.take(revision_, scan_pose_of(*taken)) != ScanUse::kIntegrated) return std::nullopt;
    const auto sensor = sensors_.find({taken->robot, taken->scan.sensor});
    if (sensor == sensors_.end() || sensor->second.kind != SensorKind::kLaser) return std::nullopt;
    if (cutters_.size() <= taken->robot) cutters_.resize(taken->robot + 1);
    auto ended = cutters_[taken->robot].add(taken->scan, sensor->second, revision_);
    if (!ended) return std::nullopt;
    return RobotCapture{taken->robot, *std::move(ended), revision_};
}

std::vector<RobotCapture> SessionCaptures::open() const {
    std::vector<RobotCapture> captures;
    for (RobotIndex robot = 0; robot < cutters_.size(); ++robot) {
        if (const auto* open = cutters_[robot].open()) captures.push_back({robot, *open, revision_});
    }
    return captures;
}

} // namespace scanloom::landmarks
