#include "robot_client/sources/pose_check.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {
namespace {

constexpr double kCell = 0.2;         // metres
constexpr double kScanDistance = 0.5; // metres travelled between scans that are looked at
constexpr std::size_t kBeams = 60;    // of a scan
constexpr double kRange = 10.0;       // metres: longer beams are not looked at
constexpr double kSurface = 0.5;      // metres before a hit that are not free space
constexpr float kEarlier = 10.0F;     // metres travelled since an earlier scan, at least
constexpr std::size_t kCellsMax = std::size_t{1} << 20;
constexpr std::size_t kHitsMin = 300; // before it decides
constexpr double kShareMax = 0.07;    // of contradictions in a correct map: people, doors, errors of poses

std::int32_t cell_of(double metres) { return static_cast<std::int32_t>(std::floor(metres / kCell)); }

std::uint64_t key_of(std::int32_t column, std::int32_t row) {
    return std::uint64_t{static_cast<std::uint32_t>(column)} << 32 | static_cast<std::uint32_t>(row);
}

} // namespace

void PoseCheck::add(const Scan& scan, const Sensor& sensor) {
    if (!scan.pose || sensor.kind != SensorKind::kLaser || scan.ranges.empty()) return;
    if (last_) {
        const Pose2 move = compose(inverse(*last_), *scan.pose);
        const double distance = std::hypot(move.x, move.y) + std::fabs(move.yaw);
        if (distance < kScanDistance) return;
        travelled_ += static_cast<float>(distance);
    }
    last_ = scan.pose;
    const Pose2 laser = compose(*scan.pose, sensor.mount);
    const BeamAngles angles = angles_of(scan, sensor);
    const std::size_t step = (scan.ranges.size() + kBeams - 1) / kBeams;
    std::vector<Point2> hits;
    for (std::size_t n = 0; n < scan.ranges.size(); n += step) {
        if (scan.ranges[n] == kInvalidRange || scan.ranges[n] == kNoReturn) continue;
        const double range = 1e-3 * scan.ranges[n];
        if (range > std::min(kRange, sensor.range_max)) continue;
        const double angle = laser.yaw + beam_angle(angles, n);
        hits.push_back({laser.x + range * std::cos(angle), laser.y + range * std::sin(angle)});
    }
    for (const Point2& hit : hits) compare(hit);
    for (const Point2& hit : hits) draw({laser.x, laser.y}, hit);
}

bool PoseCheck::was_hit_near(std::int32_t column, std::int32_t row, float until) const {
    for (std::int32_t j = row - 1; j <= row + 1; ++j) {
        for (std::int32_t i = column - 1; i <= column + 1; ++i) {
            const auto cell = cells_.find(key_of(i, j));
            if (cell != cells_.end() && cell->second.hit < until) return true;
        }
    }
    return false;
}

void PoseCheck::compare(const Point2& hit) {
    const std::int32_t column = cell_of(hit.x);
    const std::int32_t row = cell_of(hit.y);
    const float until = travelled_ - kEarlier;
    if (was_hit_near(column, row, until)) {
        ++agreed_;
        return;
    }
    const auto cell = cells_.find(key_of(column, row));
    if (cell != cells_.end() && cell->second.passed < until) ++contradicted_;
}

PoseCheck::Cell* PoseCheck::cell_at(std::int32_t column, std::int32_t row) {
    if (cells_.size() < kCellsMax) return &cells_[key_of(column, row)];
    const auto cell = cells_.find(key_of(column, row));
    return cell == cells_.end() ? nullptr : &cell->second;
}

/// Notes what a beam shows.
void PoseCheck::draw(const Point2& laser, const Point2& hit) {
    const double length = std::hypot(hit.x - laser.x, hit.y - laser.y);
    for (double along = 0.0; along < length - kSurface; along += kCell) {
        const double part = along / length;
        Cell* cell = cell_at(cell_of(laser.x + part * (hit.x - laser.x)), cell_of(laser.y + part * (hit.y - laser.y)));
        if (cell != nullptr) cell->passed = std::min(cell->passed, travelled_);
    }
    Cell* cell = cell_at(cell_of(hit.x), cell_of(hit.y));
    if (cell != nullptr) cell->hit = std::min(cell->hit, travelled_);
}

double PoseCheck::contradicted_share() const noexcept {
    return static_cast<double>(contradicted_) / static_cast<double>(std::max<std::size_t>(1, agreed_ + contradicted_));
}

bool PoseCheck::looks_like_odometry() const noexcept {
    return agreed_ + contradicted_ >= kHitsMin && contradicted_share() > kShareMax;
}

Result<std::optional<Observation>> CheckedPoses::next() {
    auto observation = source_->next();
    if (observation && *observation) check_.add((*observation)->scan, *(*observation)->sensor);
    return observation;
}

std::string CheckedPoses::remarks() const {
    std::string remarks = source_->remarks();
    if (!check_.looks_like_odometry()) return remarks;
    if (!remarks.empty()) remarks += "; ";
    return remarks + "scans contradict their poses, and these poses look like odometry: --poses odometry";
}

} // namespace scanloom::robot
