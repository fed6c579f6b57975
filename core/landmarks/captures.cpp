#include "core/landmarks/captures.hpp"

#include "common/scan/reading.hpp"

#include <cmath>
#include <utility>
#include <variant>

namespace scanloom::landmarks {
namespace {

double distance(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }
double turn(const Pose2& a, const Pose2& b) { return std::abs(normalize_angle(a.yaw - b.yaw)); }

bool is_still(const Capture& capture, const Scan& scan) {
    return distance(capture.pose, *scan.pose) <= kStillDistance && turn(capture.pose, *scan.pose) <= kStillTurn;
}

/// Returns whether a robot whose last keyframe is `last` starts another one here.
bool is_due(const Capture& last, double stamp, const Pose2& pose) {
    return distance(last.pose, pose) >= kCaptureDistance || turn(last.pose, pose) >= kCaptureTurn ||
           std::abs(stamp - last.stamp) >= kCaptureAgainAfter;
}

/// Metres: coordinates within it fit in integer millimetres, and no map is larger.
constexpr double kCoordinateLimit = 2e6;

void add_points(Capture& capture, const Scan& scan, const Sensor& sensor) {
    const Pose2 T_map_sensor = compose(*scan.pose, sensor.mount);
    const BeamAngles angles = angles_of(scan, sensor);
    const ReadingRules rules{sensor.range_min, sensor.range_max, true};
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
        const auto reading = reading_of(scan.ranges[beam], rules);
        if (!reading || !reading->is_hit) continue;
        const double direction = T_map_sensor.yaw + beam_angle(angles, beam);
        const Point2 met{T_map_sensor.x + reading->metres * std::cos(direction),
                         T_map_sensor.y + reading->metres * std::sin(direction)};
        if (max_abs(met) <= kCoordinateLimit) capture.points.push_back(in_millimetres(met));
    }
}

} // namespace

std::vector<Point2> in_metres(std::span<const PointMm> points) {
    std::vector<Point2> out;
    out.reserve(points.size());
    for (const PointMm& point : points) out.push_back(in_metres(point));
    return out;
}

std::optional<Capture> CaptureCutter::add(const Scan& scan, const Sensor& sensor, Revision revision) {
    std::optional<Capture> ended;
    if (is_open_ && !is_still(*newest_, scan)) ended = end();
    if (!is_open_) {
        if (newest_ && !is_due(*newest_, scan.stamp, *scan.pose)) return ended;
        const Pose2 T_map_sensor = compose(*scan.pose, sensor.mount);
        newest_ = Capture{*scan.pose, scan.stamp, revision, revision, 0, {}, {T_map_sensor.x, T_map_sensor.y}};
        is_open_ = true;
    }
    newest_->last = revision;
    newest_->scans += 1;
    add_points(*newest_, scan, sensor);
    if (newest_->scans == kCaptureScansMax) ended = end(); // kCaptureScansMax > 1: no other keyframe ended with it
    return ended;
}

bool CaptureCutter::needs(double stamp, const Pose2& pose) const noexcept {
    return is_open_ || !newest_ || is_due(*newest_, stamp, pose);
}

Capture CaptureCutter::end() {
    is_open_ = false;
    auto points = std::exchange(newest_->points, {});
    Capture ended = *newest_;
    ended.points = std::move(points);
    return ended;
}

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
