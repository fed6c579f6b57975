#include "server/exchange/point_text.hpp"

#include <fmt/format.h>

#include <iterator>

namespace scanloom::exchange {
namespace {

/// Appends the lines of the points to a header.
std::string with_vertices(std::string text, std::span<const landmarks::CloudPoint> points) {
    text.reserve(text.size() + points.size() * kPointTextBytes);
    for (const auto& point : points) {
        fmt::format_to(std::back_inserter(text), "{:.4f} {:.4f} 0 {}\n", point.position.x, point.position.y,
                       point.seen);
    }
    return text;
}

} // namespace

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
    const auto header = fmt::format("ply\nformat ascii 1.0\ncomment metres, map frame\nelement vertex {}\n"
                                    "property double x\nproperty double y\nproperty double z\nproperty uint seen\n"
                                    "end_header\n",
                                    points.size());
    return with_vertices(header, points);
}

std::string points_pcd(std::span<const landmarks::CloudPoint> points) {
    const auto header = fmt::format("# .PCD v0.7 - metres, map frame\nVERSION 0.7\nFIELDS x y z seen\nSIZE 4 4 4 4\n"
                                    "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
                                    "POINTS {0}\nDATA ascii\n",
                                    points.size());
    return with_vertices(header, points);
}

} // namespace scanloom::exchange
