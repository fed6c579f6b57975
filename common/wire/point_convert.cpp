#include "common/wire/point_convert.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/error_codes.hpp"
#include "common/wire/proto_convert.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::wire {

Result<> check_coordinate(std::string_view field, double metres) {
    if (!std::isfinite(metres)) return invalid_field(fmt::format("{} is {}; a finite number is needed", field, metres));
    if (std::abs(metres) > kCoordinateMax) {
        return invalid_field(fmt::format("{} is {}; at most {} either way is allowed", field, metres, kCoordinateMax));
    }
    return {};
}

Result<> check(std::string_view field, const v1::Point& point) {
    if (auto ok = check_coordinate(fmt::format("{}.x", field), point.x()); !ok) return ok;
    return check_coordinate(fmt::format("{}.y", field), point.y());
}

Result<> check_size(std::string_view field, double size) {
    if (std::isfinite(size) && size >= 0.0) return {};
    return invalid_field(fmt::format("{} is {}; a finite number from 0 on is needed", field, size));
}

Point2 value_of(const v1::Point& point) { return {point.x(), point.y()}; }

Error value_of(const v1::Refusal& refusal) { return {to_errc(refusal.code()), refusal.message()}; }

Error without_outcome() { return invalid_field("outcome is absent; a reply has a result or an error"); }

void append_differences(std::span<const PointMm> points, Differences& out) {
    out.Reserve(out.size() + static_cast<int>(2 * points.size()));
    PointMm before;
    for (const PointMm& point : points) {
        out.AddAlreadyReserved(point.x - before.x);
        out.AddAlreadyReserved(point.y - before.y);
        before = point;
    }
}

void write_point(const Point2& point, v1::Point& out) {
    out.set_x(point.x);
    out.set_y(point.y);
}

void write_refusal(const Error& refusal, v1::Refusal& out) {
    out.set_code(to_code(refusal.code));
    out.set_message(refusal.message);
}

} // namespace scanloom::wire
