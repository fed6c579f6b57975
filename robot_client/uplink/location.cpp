#include "robot_client/uplink/location.hpp"

#include "robot_client/source/seen_points.hpp"
#include "robot_client/uplink/asking.hpp"

#include <memory>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

static_assert(kSeenPointsMin == wire::kLocatePointsMin && kSeenPointsMax == wire::kLocatePointsMax);

asio::awaitable<Result<Located>> ask(Uplink& uplink, wire::LocateRequest request) {
    link::Request question = std::move(request); // a named variable, because g++ 12 destroys such temporaries twice
    const Result<link::Reply> reply = co_await ask_once_applied(uplink, std::move(question));
    if (!reply) co_return reply.error();
    const auto& correction = std::get<wire::LocateReply>(*reply).correction;
    if (!correction) co_return correction.error();
    co_return Located{correction->T_map_odom, correction->explained, correction->position_sigma, correction->yaw_sigma};
}

/// The prior of a locate request. The prior of the first place does not hold for later ones: a robot that was carried
/// away may stand at a place that looks like the first one.
struct Sought {
    std::optional<wire::Near> near;
    Point2 first_place;
    bool is_placed = false;

    void place(const Point2& place) {
        if (near) near = wire::Near{place, kCarriedMax};
        is_placed = true;
    }
};

asio::awaitable<Result<Located>> ask_where(Uplink& uplink, wire::LocateRequest request,
                                           std::shared_ptr<Sought> sought) {
    const Point2 from = request.from;
    auto located = co_await ask(uplink, std::move(request));
    if (located) {
        sought->place(transform(located->T_map_odom, from));
    } else if (located.error().code == Errc::kNothingMapped && !sought->is_placed) {
        sought->place(sought->first_place);
    }
    co_return located;
}

} // namespace

Locate located_by(Uplink& uplink, const std::optional<wire::Near>& near, const Point2& first_place) {
    const auto sought = std::make_shared<Sought>(Sought{near, first_place});
    return [&uplink, sought](std::vector<PointMm> points, Point2 from) {
        return ask_where(uplink, wire::LocateRequest{0, std::move(points), from, sought->near}, sought);
    };
}

} // namespace scanloom::robot
