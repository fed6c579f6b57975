#include "common/wire/locate_convert.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/point_convert.hpp"
#include "common/wire/proto_convert.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <utility>

namespace scanloom::wire {
namespace {

constexpr auto kMillimetresMax = static_cast<std::int64_t>(kCoordinateMax * 1e3);
constexpr double kRadiusMax = 1000.0; // metres

Result<std::vector<PointMm>> read_points(const Differences& proto) {
    const auto count = static_cast<std::size_t>(proto.size());
    if (count % 2 != 0) {
        return invalid_field(fmt::format("points has {} numbers; each point has an x and a y", count));
    }
    if (count / 2 > kLocatePointsMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("points has {} points, at most {} are allowed", count / 2, kLocatePointsMax)};
    }
    if (count / 2 < kLocatePointsMin) {
        return invalid_field(fmt::format("points has {} points; at least {} are needed", count / 2, kLocatePointsMin));
    }
    std::vector<PointMm> points;
    points.reserve(count / 2);
    std::int64_t at[2] = {0, 0};
    for (int n = 0; n < proto.size(); ++n) {
        std::int64_t& millimetres = at[n % 2];
        millimetres += proto[n];
        if (std::abs(millimetres) > kMillimetresMax) {
            return invalid_field(fmt::format("points[{}] leads to {} mm; at most {} either way is allowed", n,
                                             millimetres, kMillimetresMax));
        }
        if (n % 2 == 1) points.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1])});
    }
    return points;
}

Result<std::optional<Near>> read_near(const v1::LocateRequest& proto) {
    if (!proto.has_near()) {
        if (proto.radius() == 0.0) return std::optional<Near>();
        return invalid_field("radius is given, but near is not; give the centre in near");
    }
    if (auto ok = check("near", proto.near()); !ok) return ok.error();
    if (!(proto.radius() > 0.0 && proto.radius() <= kRadiusMax)) {
        return invalid_field(
            fmt::format("radius is {} m; it must be more than 0 and at most {}", proto.radius(), kRadiusMax));
    }
    return std::optional(Near{value_of(proto.near()), proto.radius()});
}

} // namespace

Result<Correction> from_proto(const v1::Correction& proto) {
    auto pose = from_proto(proto.t_map_odom());
    if (!pose) return prefixed("T_map_odom.", pose.error());
    if (!(proto.explained() >= 0.0 && proto.explained() <= 1.0)) {
        return invalid_field(fmt::format("explained is {}; a part from 0 to 1 is needed", proto.explained()));
    }
    if (auto ok = check_size("position_sigma", proto.position_sigma()); !ok) return ok.error();
    if (auto ok = check_size("yaw_sigma", proto.yaw_sigma()); !ok) return ok.error();
    return Correction{*pose, proto.revision(), proto.explained(), proto.position_sigma(), proto.yaw_sigma()};
}

Result<LocateRequest> from_proto(const v1::LocateRequest& proto) {
    LocateRequest request;
    request.id = proto.id();
    auto points = read_points(proto.points());
    if (!points) return points.error();
    request.points = std::move(*points);
    if (proto.has_from()) {
        if (auto ok = check("from", proto.from()); !ok) return ok.error();
        request.from = value_of(proto.from());
    }
    auto near = read_near(proto);
    if (!near) return near.error();
    request.near = *near;
    return request;
}

Result<LocateReply> from_proto(const v1::LocateReply& proto) {
    if (proto.has_refusal()) return LocateReply{proto.id(), proto.revision(), value_of(proto.refusal())};
    if (!proto.has_correction()) return without_outcome();
    auto correction = from_proto(proto.correction());
    if (!correction) return prefixed("correction.", correction.error());
    return LocateReply{proto.id(), proto.revision(), *correction};
}

void to_proto(const Correction& correction, v1::Correction& out) {
    to_proto(correction.T_map_odom, *out.mutable_t_map_odom());
    out.set_revision(correction.revision);
    out.set_explained(correction.explained);
    out.set_position_sigma(correction.position_sigma);
    out.set_yaw_sigma(correction.yaw_sigma);
}

void to_proto(const LocateRequest& request, v1::LocateRequest& out) {
    out.set_id(request.id);
    append_differences(request.points, *out.mutable_points());
    write_point(request.from, *out.mutable_from());
    if (!request.near) return;
    write_point(request.near->point, *out.mutable_near());
    out.set_radius(request.near->radius);
}

void to_proto(const LocateReply& reply, v1::LocateReply& out) {
    out.set_id(reply.id);
    out.set_revision(reply.revision);
    if (reply.correction) {
        to_proto(*reply.correction, *out.mutable_correction());
    } else {
        write_refusal(reply.correction.error(), *out.mutable_refusal());
    }
}

} // namespace scanloom::wire
