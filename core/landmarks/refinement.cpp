#include "core/landmarks/refinement.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace scanloom::landmarks {
namespace {

constexpr double kUndetermined = 1e-9; // relative to the value for points that agree

constexpr int kIcpStepsMax = 20;
constexpr double kIcpDistance = 0.5;  // metres; pairs further apart do not correspond
constexpr double kIcpFraction = 0.75; // fraction of these pairs that is used
constexpr std::size_t kIcpPairsMin = 10;
constexpr double kIcpConverged = 2e-3; // metres, and radians

constexpr int kFitStepsMax = 15;
constexpr double kFitDistance = 0.15;        // metres between elements that correspond
constexpr double kResidualMax = 0.08;        // metres from a line
constexpr double kCorrespondingCosine = 0.9; // cosine between normals that correspond
constexpr double kRoundWeight = 0.2;         // of an element that is not straight: its position depends on the view
constexpr double kDamping = 1e-3;            // of the elements used: constrains what no line constrains
constexpr double kFitConverged = 1e-5;       // metres, and radians

bool has_converged(const Pose2& before, const Pose2& after, double limit) {
    return std::hypot(after.x - before.x, after.y - before.y) < limit &&
           std::abs(normalize_angle(after.yaw - before.yaw)) < limit;
}

struct ClosePair {
    PointPair pair;
    double distance;
};

std::vector<PointPair> closest_pairs(const Surface& first, std::span<const Surfel> second, const Pose2& pose) {
    std::vector<ClosePair> close;
    for (const Surfel& there : second) {
        const auto near = first.nearest_within(transform(pose, there.position), kIcpDistance);
        if (near) close.push_back({{first.surfels()[near->index].position, there.position}, near->distance});
    }
    std::ranges::stable_sort(close, {}, &ClosePair::distance);
    close.resize(static_cast<std::size_t>(kIcpFraction * static_cast<double>(close.size())));
    std::vector<PointPair> pairs;
    for (const auto& [pair, distance] : close) pairs.push_back(pair);
    return pairs;
}

/// The normal equations of one Gauss-Newton step: matrix * step = gradient.
struct NormalEquations {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double squares = 0.0;
    double weights = 0.0;
    double agreement = 0.0;
    std::size_t used = 0;

    void add(const Point2& normal, const Point2& from_second_origin, double residual, double weight) {
        const Point2 turned{-from_second_origin.y, from_second_origin.x};
        const Eigen::Vector3d jacobian(normal.x, normal.y, dot(normal, turned));
        matrix += weight * jacobian * jacobian.transpose();
        gradient -= weight * residual * jacobian;
        squares += weight * residual * residual;
        weights += weight;
    }
};

/// Adds a pair of elements that may correspond, one of each surface, both in the first's frame.
/// @param line    normal of the line that the distance is measured from
/// @param origin  of the second's frame
void add(NormalEquations& equations, const Surfel& here, const Surfel& there, const Point2& line,
         const Point2& origin) {
    if (here.is_straight() != there.is_straight()) return;
    const Point2 offset = there.position - here.position;
    const Point2 from_origin = there.position - origin;
    const double off = here.is_straight() ? dot(line, offset) : norm(offset);
    const double closeness = 1.0 - off * off / (kResidualMax * kResidualMax);
    if (closeness <= 0.0) return;
    if (here.is_straight()) {
        if (std::abs(dot(here.normal, there.normal)) < kCorrespondingCosine) return;
        equations.add(line, from_origin, off, closeness * closeness); // Tukey's biweight
        equations.agreement += closeness * closeness * closeness;     // the objective that the biweight maximizes
    } else {
        equations.add({1.0, 0.0}, from_origin, offset.x, kRoundWeight);
        equations.add({0.0, 1.0}, from_origin, offset.y, kRoundWeight);
        equations.agreement += kRoundWeight * closeness;
    }
    ++equations.used;
}

/// Adds the elements of both surfaces, each with the nearest of the other surface and that one's line.
NormalEquations normal_equations(const Surface& first, const Surface& second, const Pose2& pose) {
    NormalEquations equations;
    const Point2 origin{pose.x, pose.y};
    const Pose2 back = inverse(pose);
    for (const Surfel& element : second.surfels()) {
        const Surfel there = transformed(pose, element);
        const auto near = first.nearest_within(there.position, kFitDistance);
        if (!near) continue;
        const Surfel& here = first.surfels()[near->index];
        add(equations, here, there, here.normal, origin);
    }
    for (const Surfel& here : first.surfels()) {
        const auto near = second.nearest_within(transform(back, here.position), kFitDistance);
        if (!near) continue;
        const Surfel there = transformed(pose, second.surfels()[near->index]);
        add(equations, here, there, there.normal, origin);
    }
    return equations;
}

} // namespace

std::optional<Pose2> align_pairs(std::span<const PointPair> pairs) {
    if (pairs.size() < 2) return std::nullopt;
    const auto count = static_cast<double>(pairs.size());
    Point2 first_centre{0.0, 0.0};
    Point2 second_centre{0.0, 0.0};
    for (const PointPair& pair : pairs) {
        first_centre += pair.first;
        second_centre += pair.second;
    }
    first_centre /= count;
    second_centre /= count;
    double along = 0.0;
    double across = 0.0;
    double first_extent = 0.0;
    double second_extent = 0.0;
    for (const PointPair& pair : pairs) {
        const Point2 first = pair.first - first_centre;
        const Point2 second = pair.second - second_centre;
        along += dot(second, first);
        across += second.x * first.y - second.y * first.x;
        first_extent += squared_norm(first);
        second_extent += squared_norm(second);
    }
    const double size = std::max(max_abs(first_centre), max_abs(second_centre));
    const double rounding = 1e-14 * size * size * count; // what remains of equal points minus their mean
    if (std::hypot(along, across) <= kUndetermined * std::sqrt(first_extent * second_extent) + rounding) {
        return std::nullopt;
    }
    const double yaw = normalize_angle(std::atan2(across, along));
    const Point2 translation = first_centre - transform({0.0, 0.0, yaw}, second_centre);
    return Pose2{translation.x, translation.y, yaw};
}

Pose2 refine_by_icp(const Surface& first, std::span<const Surfel> second, const Pose2& T_first_second) {
    Pose2 pose = T_first_second;
    for (int step = 0; step < kIcpStepsMax; ++step) {
        const auto pairs = closest_pairs(first, second, pose);
        if (pairs.size() < kIcpPairsMin) break;
        const auto fit = align_pairs(pairs);
        if (!fit) break;
        const bool converged = has_converged(pose, *fit, kIcpConverged);
        pose = *fit;
        if (converged) break;
    }
    return pose;
}

LineFit fit_to_lines(const Surface& first, const Surface& second, const Pose2& T_first_second) {
    LineFit fit{.T_first_second = T_first_second};
    for (int step = 0; step < kFitStepsMax; ++step) {
        const auto equations = normal_equations(first, second, fit.T_first_second);
        if (equations.used == 0) break;
        fit.used = equations.used;
        fit.agreement = equations.agreement;
        fit.rms = std::sqrt(equations.squares / equations.weights);
        fit.normal_matrix = equations.matrix;
        const Eigen::Matrix3d damped =
            equations.matrix + kDamping * static_cast<double>(equations.used) * Eigen::Matrix3d::Identity();
        const Eigen::Vector3d change = damped.ldlt().solve(equations.gradient);
        const Pose2 before = fit.T_first_second;
        fit.T_first_second = {before.x + change.x(), before.y + change.y(), normalize_angle(before.yaw + change.z())};
        if (has_converged(before, fit.T_first_second, kFitConverged)) break;
    }
    return fit;
}

} // namespace scanloom::landmarks
