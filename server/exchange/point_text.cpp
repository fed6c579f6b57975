#include "server/exchange/point_text.hpp"

#include <fmt/format.h>

#include <iterator>

namespace scanloom::exchange {

std::string points_csv(std::span<const landmarks::CloudPoint> points, std::span<const std::string> robots) {
    std::string text = "angle,distance,x,y,seen,robot,revision\n";
    text.reserve(points.size() * kPointTextBytes);
    for (const auto& point : points) {
        fmt::format_to(std::back_inserter(text), "{:.5f},{:.4f},{:.4f},{:.4f},{},{},{}\n", point.angle, point.distance,
                       point.position.x, point.position.y, point.seen, robots[point.robot], point.revision);
    }
    return text;
}

std::string points_ply(std::span<const landmarks::CloudPoint> points) {
    std::string text = fmt::format("ply\nformat ascii 1.0\ncomment metres, map frame\nelement vertex {}\n"
                                   "property double x\nproperty double y\nproperty double z\nproperty uint seen\n"
                                   "end_header\n",
                                   points.size());
    text.reserve(points.size() * kPointTextBytes);
    for (const auto& point : points) {
        fmt::format_to(std::back_inserter(text), "{:.4f} {:.4f} 0 {}\n", point.position.x, point.position.y,
                       point.seen);
    }
    return text;
}

} // namespace scanloom::exchange
