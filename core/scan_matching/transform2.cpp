#include "core/scan_matching/transform2.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace scanloom::scan_matching {
namespace {

constexpr std::size_t kTerms = 9;      // of the series of sine and cosine, up to pi/4
constexpr std::size_t kAtanTerms = 22; // of the arc tangent, up to tan(pi/8)

/// Returns the coefficients of the Taylor series of cos(x) (first = 0) or sin(x) / x (first = 1) in x squared.
constexpr std::array<double, kTerms> series(std::size_t first) {
    std::array<double, kTerms> coefficients{};
    double factorial = 1.0;
    for (std::size_t n = 0; n < kTerms; ++n) {
        const std::size_t power = 2 * n + first;
        if (n > 0) factorial *= static_cast<double>(power) * static_cast<double>(power - 1);
        coefficients[n] = (n % 2 == 0 ? 1.0 : -1.0) / factorial;
    }
    return coefficients;
}

constexpr auto kCos = series(0);
constexpr auto kSin = series(1);

double polynomial(const std::array<double, kTerms>& coefficients, double x) noexcept {
    double sum = 0.0;
    for (std::size_t n = kTerms; n-- > 0;) sum = sum * x + coefficients[n];
    return sum;
}

/// Returns atan(t) for |t| <= tan(pi/8).
double atan_of_small(double t) noexcept {
    const double square = t * t;
    double sum = 0.0;
    for (std::size_t n = kAtanTerms; n-- > 0;)
        sum = (n % 2 == 0 ? 1.0 : -1.0) / static_cast<double>(2 * n + 1) + square * sum;
    return t * sum;
}

} // namespace

SinCos sin_cos(double angle_rad) noexcept {
    constexpr double kQuarter = std::numbers::pi / 2.0;
    int quarters = 0;
    const double rest = std::remquo(angle_rad, kQuarter, &quarters); // exact, in [-pi/4, pi/4]
    const double square = rest * rest;
    const double s = rest * polynomial(kSin, square);
    const double c = polynomial(kCos, square);
    switch (static_cast<unsigned>(quarters) % 4U) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
    }
}

double angle_of(double y, double x) noexcept {
    const double low = std::fmin(std::fabs(x), std::fabs(y));
    const double high = std::fmax(std::fabs(x), std::fabs(y));
    if (high == 0.0) return 0.0;
    constexpr double kTanOfEighth = std::numbers::sqrt2 - 1.0; // tan(pi/8)
    const double ratio = low / high;
    double angle = ratio <= kTanOfEighth ? atan_of_small(ratio)
                                         : std::numbers::pi / 4.0 + atan_of_small((ratio - 1.0) / (ratio + 1.0));
    if (std::fabs(y) > std::fabs(x)) angle = std::numbers::pi / 2.0 - angle;
    if (x < 0.0) angle = std::numbers::pi - angle;
    return y < 0.0 ? -angle : angle;
}

Transform2 transform_of(const Pose2& pose) noexcept { return {pose.x, pose.y, sin_cos(pose.yaw)}; }

Pose2 pose_of(const Transform2& T_a_b) noexcept { return {T_a_b.x, T_a_b.y, yaw_of(T_a_b)}; }

} // namespace scanloom::scan_matching
