#include "server/http/handlers/handlers.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::http {
namespace {

constexpr double kRadius = 10.0;      // metres, if the request states none
constexpr double kRadiusMax = 1000.0; // metres

/// Reads where a robot is.
Result<RobotRelocalized> read_relocalized(const boost::json::object& body, const mapping::Snapshot& maps) {
    const auto name = read_text(body, "robot");
    if (!name) return name.error();
    const auto robot = robot_named(maps, *name);
    if (!robot) return robot.error();
    const auto* place = body.if_contains("near");
    if (place == nullptr) return Error{Errc::kInvalidField, "near is missing; give [x, y] in metres of the map frame"};
    const auto near = read_point(*place, "near");
    if (!near) return near.error();
    const auto radius = read_number(body, "radius");
    if (!radius) return radius.error();
    const double metres = radius->value_or(kRadius);
    if (metres > 0.0 && metres <= kRadiusMax) return RobotRelocalized{*robot, *near, metres};
    return Error{Errc::kInvalidField,
                 fmt::format("radius is {}; give metres, above 0 and at most {}", metres, kRadiusMax)};
}

} // namespace

boost::asio::awaitable<Result<Response>> relocalize(Context& context) {
    const auto body = parse_json_object(context.request.body, {"robot", "near", "radius"});
    if (!body) co_return body.error();
    const auto relocalized = read_relocalized(*body, *context.session->snapshot());
    if (!relocalized) co_return relocalized.error();
    const auto taken = co_await sockets::resume_with<Result<>>(
        [&](auto done) { context.session->relocalize(*relocalized, std::move(done)); });
    if (!taken) co_return taken.error();
    Response response = ok(boost::json::object{
        {"robot", body->at("robot")}, {"near", position(relocalized->near)}, {"radius", relocalized->radius}});
    response.status = Status::accepted;
    co_return response;
}

boost::asio::awaitable<Result<Response>> change_mode(Context& context) {
    const auto body = parse_json_object(context.request.body, {"localize_only"});
    if (!body) co_return body.error();
    const auto localize_only = read_flag(*body, "localize_only");
    if (!localize_only) co_return localize_only.error();
    if (!*localize_only) co_return Error{Errc::kInvalidField, "localize_only is missing; give true or false"};
    const ModeChanged changed{**localize_only};
    const auto taken = co_await sockets::resume_with<Result<>>(
        [&](auto done) { context.session->change_mode(changed, std::move(done)); });
    if (!taken) co_return taken.error();
    Response response = ok(boost::json::object{{"localize_only", changed.is_localize_only}});
    response.status = Status::accepted;
    co_return response;
}

} // namespace scanloom::http
