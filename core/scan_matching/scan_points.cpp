#include "core/scan_matching/scan_points.hpp"

#include "core/scan_matching/transform2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace scanloom::scan_matching {
namespace {

constexpr std::size_t kNeighborsMax = 5;    // on each side of a point, for its normal
constexpr double kNeighborReach = 0.30;     // metres from the point, and two beams' distance
constexpr double kNeighborDistance = 0.03;  // metres from one neighbour to the next; nearer ones are passed over
constexpr double kGapMin = 0.24;            // metres between neighbours of one surface, or five beams' distance
constexpr double kLineDeviationMax = 0.02;  // metres, standard deviation from the line
constexpr double kLineFlatness = 0.05;      // largest ratio of the variances across and along the line
constexpr std::size_t kGrazingBeams = 5;    // neighbours that show a wall which they graze
constexpr double kGrazingSine = 0.3;        // largest sine of the angle between such a wall and its beam
constexpr double kGrazingDeviation = 0.006; // metres: errors of the range move such points along the wall

/// The hits of a scan in the sensor frame, in metres, and the mean angle between beams.
struct Hits {
    std::vector<Point2> points;
    std::vector<char> is_hit;
    std::vector<double> ranges;
    double beam_angle = 0.0;
};

Hits hits_of(const Scan& scan, const Sensor& sensor) {
    const BeamAngles angles = angles_of(scan, sensor);
    const std::size_t count = scan.ranges.size();
    Hits hits{std::vector<Point2>(count, Point2{0.0, 0.0}), std::vector<char>(count, 0),
              std::vector<double>(count, 0.0)};
    const double farthest = std::min(sensor.range_max, kHitDistanceMax);
    for (std::size_t n = 0; n < count; ++n) {
        const double range = scan.ranges[n] * 1e-3;
        hits.is_hit[n] = scan.ranges[n] != kNoReturn && scan.ranges[n] != kInvalidRange && range >= sensor.range_min &&
                         range < farthest;
        if (hits.is_hit[n] == 0) continue;
        const auto [s, c] = sin_cos(beam_angle(angles, n));
        hits.ranges[n] = range;
        hits.points[n] = {range * c, range * s};
    }
    double turned = 0.0;
    for (std::size_t n = 1; n < count; ++n) {
        turned += std::fabs(normalize_angle(beam_angle(angles, n) - beam_angle(angles, n - 1)));
    }
    if (count > 1) hits.beam_angle = turned / static_cast<double>(count - 1);
    return hits;
}

double squared_distance(const Point2& a, const Point2& b) {
    const double dx = a.x - b.x;
    const double dy = a.y - b.y;
    return dx * dx + dy * dy;
}

/// Returns the unit normal, towards the laser, of the line that points fit; the null vector if they do not fit one.
/// @param deviation_max  metres, largest standard deviation of the points from the line
Point2 normal_of(std::span<const Point2> points, double deviation_max) {
    const auto count = static_cast<double>(points.size());
    Point2 mean{0.0, 0.0};
    for (const Point2& point : points) mean = {mean.x + point.x, mean.y + point.y};
    mean = {mean.x / count, mean.y / count};
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const Point2& point : points) {
        const double dx = point.x - mean.x;
        const double dy = point.y - mean.y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    const double half_trace = 0.5 * (xx + yy);
    const double root = std::sqrt(std::max(0.0, half_trace * half_trace - (xx * yy - xy * xy)));
    const double across = half_trace - root;
    const double along = half_trace + root;
    if (across >= kLineFlatness * along || across >= count * deviation_max * deviation_max) return {0.0, 0.0};
    // The eigenvector of the smaller eigenvalue, from the row that is farther from zero.
    Point2 normal = std::fabs(xx - across) < std::fabs(yy - across) ? Point2{across - yy, xy} : Point2{xy, across - xx};
    const double length = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    if (length == 0.0) return {0.0, 0.0};
    const bool is_away = normal.x * mean.x + normal.y * mean.y > 0.0;
    const double scale = (is_away ? -1.0 : 1.0) / length;
    return {normal.x * scale, normal.y * scale};
}

/// Returns the normal of a wall that a beam grazes, the null vector if none shows. Beams that graze a wall hit it at
/// places that are too far apart to be one surface by distance: 1.7 m, for beams 1 degree apart that hit 10 m away.
/// Matched to points, they would hold the robot back: along such a wall, each scan shows the same points.
Point2 grazed_normal_at(const Hits& hits, std::size_t hit) {
    for (const std::size_t before : {2, 3, 1, 4, 0}) { // beams of the group before the hit, best in its middle
        if (hit < before || hit - before + kGrazingBeams > hits.points.size()) continue;
        const std::size_t first = hit - before;
        if (std::ranges::count(std::span(hits.is_hit).subspan(first, kGrazingBeams), 0) != 0) continue;
        const Point2 normal = normal_of(std::span(hits.points).subspan(first, kGrazingBeams), kGrazingDeviation);
        const Point2& point = hits.points[hit];
        const double sine = std::fabs(normal.x * point.x + normal.y * point.y) / hits.ranges[hit];
        return sine < kGrazingSine ? normal : Point2{0.0, 0.0};
    }
    return {0.0, 0.0};
}

/// Returns the normal at a hit, from its neighbours on the same surface. Where beams are dense, most are passed over:
/// the noise of the nearest ones would hide the line. Points without a normal are matched to points, and with many of
/// them walls hold the robot back along a corridor.
Point2 normal_at(const Hits& hits, std::size_t hit) {
    const double beam_distance = hits.ranges[hit] * hits.beam_angle;
    const double reach2 = kNeighborReach * kNeighborReach + 4.0 * beam_distance * beam_distance;
    const double gap = std::max(kGapMin, 5.0 * beam_distance);
    const auto continues = [&](std::size_t from, std::size_t to) {
        return hits.is_hit[to] != 0 && squared_distance(hits.points[from], hits.points[to]) < gap * gap &&
               squared_distance(hits.points[hit], hits.points[to]) < reach2;
    };
    const auto beams = static_cast<double>(hits.points.size());
    const auto step = static_cast<std::size_t>(std::clamp(kNeighborDistance / beam_distance, 1.0, beams));
    std::array<Point2, 2 * kNeighborsMax + 1> surface;
    std::size_t count = 0;
    surface[count++] = hits.points[hit];
    for (std::size_t n = hit; n >= step && count <= kNeighborsMax && continues(n, n - step); n -= step) {
        surface[count++] = hits.points[n - step];
    }
    const std::size_t most = count + kNeighborsMax;
    for (std::size_t n = hit; n + step < hits.points.size() && count < most && continues(n, n + step); n += step) {
        surface[count++] = hits.points[n + step];
    }
    return count < 3 ? grazed_normal_at(hits, hit) : normal_of(std::span(surface).first(count), kLineDeviationMax);
}

} // namespace

bool are_in_reach(const ScanPoints& scan) noexcept {
    const auto is_within = [](double x, double y, double distance) { return x * x + y * y <= distance * distance; };
    return is_within(scan.laser.x, scan.laser.y, kMountDistanceMax) &&
           std::ranges::all_of(scan.points, [&](const SurfacePoint& point) {
               return is_within(point.x, point.y, kMountDistanceMax + kHitDistanceMax);
           });
}

ScanPoints points_of(const Scan& scan, const Sensor& sensor) {
    const Pose2& mount = sensor.mount;
    if (!(mount.x * mount.x + mount.y * mount.y <= kMountDistanceMax * kMountDistanceMax)) return {};
    const Hits hits = hits_of(scan, sensor);
    const Transform2 T_robot_sensor = transform_of(sensor.mount);
    const auto [s, c] = T_robot_sensor.rotation;
    const auto count = static_cast<std::size_t>(std::count(hits.is_hit.begin(), hits.is_hit.end(), 1));
    const std::size_t step = (count + kScanPointsMax - 1) / kScanPointsMax;
    ScanPoints shown{{}, {sensor.mount.x, sensor.mount.y}};
    shown.points.reserve(std::min(count, kScanPointsMax));
    std::size_t skipped = step;
    for (std::size_t n = 0; n < hits.points.size(); ++n) {
        if (hits.is_hit[n] == 0 || skipped++ % step != 0) continue;
        const Point2 point = T_robot_sensor * hits.points[n];
        const Point2 normal = normal_at(hits, n);
        shown.points.push_back(
            {float(point.x), float(point.y), float(c * normal.x - s * normal.y), float(s * normal.x + c * normal.y)});
    }
    return shown;
}

} // namespace scanloom::scan_matching
