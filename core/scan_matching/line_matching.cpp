#include "core/scan_matching/line_matching.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace scanloom::scan_matching {
namespace {

constexpr double kIsolatedWeight = 0.3; // of a pair without a normal, compared with one that has one
constexpr double kFarthest = 3.0;       // metres from the start; a result farther away is a failure
constexpr double kSingular = 1e-12;     // determinant, rad^-2 m^-4
constexpr double kShrinkPart = 0.6;     // of the steps, in which gate and scale shrink

// A step below these is short: the last gate and scale follow at once.
constexpr double kShortStep = 0.01;  // metres
constexpr double kShortTurn = 0.003; // radians

// Below these, the pose has converged.
constexpr double kConvergedStep = 0.0005; // metres
constexpr double kConvergedTurn = 0.0002; // radians

/// The change of a pose in one step: metres in the map's frame, radians.
struct Step {
    double x = 0.0;
    double y = 0.0;
    double yaw = 0.0;
};

/// Sums of a least-squares problem in (x, y, yaw): the symmetric matrix of the normal equations and their right side.
struct NormalEquations {
    double xx = 0.0;
    double xy = 0.0;
    double xyaw = 0.0;
    double yy = 0.0;
    double yyaw = 0.0;
    double yawyaw = 0.0;
    Step right;

    /// Adds a residual along a direction.
    /// @param direction  unit vector
    /// @param arm        derivative of the residual by the yaw, metres
    void add(double weight, const Point2& direction, double arm, double residual) {
        xx += weight * direction.x * direction.x;
        xy += weight * direction.x * direction.y;
        xyaw += weight * direction.x * arm;
        yy += weight * direction.y * direction.y;
        yyaw += weight * direction.y * arm;
        yawyaw += weight * arm * arm;
        right.x += weight * direction.x * residual;
        right.y += weight * direction.y * residual;
        right.yaw += weight * arm * residual;
    }

    /// Returns the solution, or nullopt if the matrix is singular.
    [[nodiscard]] std::optional<Step> solved() const {
        const Cofactors of = cofactors();
        if (!(std::fabs(of.determinant) > kSingular)) return std::nullopt;
        return Step{(of.xx * right.x + of.xy * right.y + of.xyaw * right.yaw) / of.determinant,
                    (of.xy * right.x + of.yy * right.y + of.yyaw * right.yaw) / of.determinant,
                    (of.xyaw * right.x + of.yyaw * right.y + of.yawyaw * right.yaw) / of.determinant};
    }

    /// Sets the standard deviations of the solution, from the inverse of the matrix. Precondition: it is not singular.
    void set_sigmas(LineMatch& match) const {
        const Cofactors of = cofactors();
        const double half_trace = 0.5 * (of.xx + of.yy);
        const double root = std::sqrt(std::max(0.0, half_trace * half_trace - (of.xx * of.yy - of.xy * of.xy)));
        match.position_sigma = std::sqrt((half_trace + root) / of.determinant);
        match.yaw_sigma = std::sqrt(of.yawyaw / of.determinant);
    }

    /// Returns the smallest by the largest eigenvalue of the position's part.
    [[nodiscard]] double conditioning() const {
        const double half_trace = 0.5 * (xx + yy);
        const double root = std::sqrt(std::max(0.0, half_trace * half_trace - (xx * yy - xy * xy)));
        return half_trace > 0.0 ? (half_trace - root) / (half_trace + root) : 0.0;
    }

private:
    /// The cofactors of the matrix, which are symmetric, too; divided by the determinant they are its inverse.
    struct Cofactors {
        double xx, xy, xyaw, yy, yyaw, yawyaw;
        double determinant;
    };

    [[nodiscard]] Cofactors cofactors() const {
        Cofactors of{yy * yawyaw - yyaw * yyaw,
                     xyaw * yyaw - xy * yawyaw,
                     xy * yyaw - xyaw * yy,
                     xx * yawyaw - xyaw * xyaw,
                     xy * xyaw - xx * yyaw,
                     xx * yy - xy * xy,
                     0.0};
        of.determinant = xx * of.xx + xy * of.xy + xyaw * of.xyaw;
        return of;
    }
};

/// Adds the pair of a point and its partner in the map.
/// @param point  in the map's frame
/// @param robot  its position
/// @param scale  metres: where the weight falls
void add_pair(NormalEquations& sums, const SurfacePoint& point, const PointMap::Neighbor& partner,
              const Transform2& robot, double scale, double information) {
    const Point2 offset{double{partner.point->x} - point.x, double{partner.point->y} - point.y};
    const Point2 arm{-(double{point.y} - robot.y), double{point.x} - robot.x}; // derivative of the point by the yaw
    const double scale2 = scale * scale;
    const bool has_line = partner.point->has_normal();
    if (!has_line && !point.has_normal()) {
        const double ratio = scale2 / (scale2 + partner.squared_distance);
        const double weight = kIsolatedWeight * information * ratio * ratio;
        sums.add(weight, {1.0, 0.0}, arm.x, offset.x);
        sums.add(weight, {0.0, 1.0}, arm.y, offset.y);
        return;
    }
    const SurfacePoint& line = has_line ? *partner.point : point;
    const Point2 normal{line.normal_x, line.normal_y};
    const double residual = normal.x * offset.x + normal.y * offset.y;
    const double ratio = scale2 / (scale2 + residual * residual);
    sums.add(information * ratio * ratio, normal, normal.x * arm.x + normal.y * arm.y, residual);
}

} // namespace

double inlier_ratio(std::span<const SurfacePoint> points, const PointMap& map, const Transform2& T_map_robot) {
    if (points.empty()) return 0.0;
    const auto count = std::ranges::count_if(points, [&](const SurfacePoint& point) {
        return map.nearest(transform(T_map_robot, point), kInlierDistance).point != nullptr;
    });
    return static_cast<double>(count) / static_cast<double>(points.size());
}

LineMatch match_to_lines(std::span<const SurfacePoint> points, const PointMap& map, const Transform2& start,
                         const PosePrior& prior, const MatchSchedule& schedule) {
    const double information = 1.0 / (schedule.point_sigma * schedule.point_sigma);
    const double prior_position = 1.0 / (prior.position_sigma * prior.position_sigma);
    const double prior_yaw = 1.0 / (prior.yaw_sigma * prior.yaw_sigma);
    LineMatch match{.T_map_robot = start};
    Transform2& pose = match.T_map_robot;
    double progress = 0.0; // 0: first gate and scale; from 1: the last
    std::optional<NormalEquations> last;
    for (int step = 0; step < schedule.steps_max; ++step) {
        const double part = std::min(1.0, progress);
        const auto gate = static_cast<float>(schedule.first_gate + part * (schedule.last_gate - schedule.first_gate));
        const double scale = schedule.first_scale + part * (schedule.last_scale - schedule.first_scale);
        NormalEquations sums;
        for (const SurfacePoint& point : points) {
            const SurfacePoint moved = transform(pose, point);
            const auto partner = map.nearest(moved, gate);
            if (partner.point != nullptr) add_pair(sums, moved, partner, pose, scale, information);
        }
        match.conditioning = sums.conditioning();
        sums.xx += prior_position;
        sums.yy += prior_position;
        sums.yawyaw += prior_yaw;
        sums.right.x += prior_position * (prior.T_map_robot.x - pose.x);
        sums.right.y += prior_position * (prior.T_map_robot.y - pose.y);
        sums.right.yaw += prior_yaw * yaw_of(inverse(pose) * prior.T_map_robot);
        const auto change = sums.solved();
        if (!change) {
            match.is_refined = false;
            pose = start;
            break;
        }
        last = sums;
        pose = {pose.x + change->x, pose.y + change->y, pose.rotation * sin_cos(change->yaw)};
        const double squared = (pose.x - start.x) * (pose.x - start.x) + (pose.y - start.y) * (pose.y - start.y);
        if (!(squared <= kFarthest * kFarthest)) {
            match.is_refined = false;
            pose = start;
            break;
        }
        const double step2 = change->x * change->x + change->y * change->y;
        const double turn = std::fabs(change->yaw);
        progress += 1.0 / (kShrinkPart * schedule.steps_max);
        if (part < 1.0 && step2 < kShortStep * kShortStep && turn < kShortTurn) progress = 1.0;
        if (part >= 1.0 && step2 < kConvergedStep * kConvergedStep && turn < kConvergedTurn) break;
    }
    if (match.is_refined && last) {
        last->set_sigmas(match);
    } else {
        match.position_sigma = prior.position_sigma;
        match.yaw_sigma = prior.yaw_sigma;
    }
    match.inlier_ratio = inlier_ratio(points, map, pose);
    return match;
}

} // namespace scanloom::scan_matching
