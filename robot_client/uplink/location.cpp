#include "robot_client/uplink/location.hpp"

#include "robot_client/source/seen_points.hpp"
#include "robot_client/uplink/asking.hpp"

#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

static_assert(kSeenPointsMin == wire::kLocatePointsMin && kSeenPointsMax == wire::kLocatePointsMax);

asio::awaitable<Result<Located>> ask(Uplink& uplink, wire::LocateRequest request) {
    Request question = std::move(request); // named, as g++ 12 destroys such temporaries twice
    const Result<Reply> reply = co_await ask_once_applied(uplink, std::move(question));
    if (!reply) co_return reply.error();
    const auto& correction = std::get<wire::LocateReply>(*reply).correction;
    if (!correction) co_return correction.error();
    co_return Located{correction->T_map_odom, correction->explained, correction->position_sigma, correction->yaw_sigma};
}

} // namespace

Locate located_by(Uplink& uplink, std::optional<wire::Near> near) {
    return [&uplink, near](std::vector<PointMm> points, Point2 from) {
        return ask(uplink, wire::LocateRequest{0, std::move(points), from, near});
    };
}

} // namespace scanloom::robot
