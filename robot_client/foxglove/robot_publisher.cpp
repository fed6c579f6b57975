#include "robot_client/foxglove/robot_publisher.hpp"

#include "common/net/await_tuple.hpp"
#include "robot_client/foxglove/map_download.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

RosTime unix_now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

} // namespace

RobotPublisher::RobotPublisher(RobotPublisherOptions options, foxglove::BridgeSession& session, WakeSignal& to_send,
                               Note note)
    : options_(std::move(options)), session_(session), to_send_(to_send), note_(std::move(note)) {
    if (options_.transform) transforms_ = session_.add_publication("/tf", std::string(kTransformsType));
    if (options_.map) maps_ = session_.add_publication("/map", std::string(kGridType));
}

Result<> RobotPublisher::check(const FrameChoice& frames, const std::vector<std::string>& ancestors) const {
    const auto conflict = [](std::string text) { return Error{Errc::kConflict, std::move(text)}; };
    if (options_.transform && frames.poses != Poses::kOdometry) {
        return conflict(fmt::format("--publish-tf needs odometry, but the robot's poses are: {}; use --poses odometry, "
                                    "or leave --publish-tf out",
                                    name_of(frames.poses)));
    }
    if (options_.transform && ancestors.size() > 1) {
        return conflict(fmt::format("--publish-tf: another program publishes {} -> {}, and two publishers of it would "
                                    "fight; stop that program, such as amcl or slam_toolbox, or leave --publish-tf out",
                                    ancestors[1], ancestors[0]));
    }
    if (options_.transform && options_.map_frame == frames.fixed) {
        return conflict(fmt::format("--map-frame {}: this is the robot's frame of odometry; give the map another name",
                                    options_.map_frame));
    }
    const auto problem = is_asked() ? session_.publish_problem() : std::string();
    if (problem.empty()) return {};
    return conflict(fmt::format("{}: {}", options_.transform ? "--publish-tf" : "--publish-map", problem));
}

void RobotPublisher::on_connected() const {
    const auto problem = is_asked() ? session_.publish_problem() : std::string();
    if (!problem.empty()) note_("nothing is published: " + problem);
}

void RobotPublisher::add_stamp(RosTime stamp) { clock_.add(stamp, unix_now_ns()); }

asio::awaitable<void> RobotPublisher::run(std::string odom_frame) {
    co_await (publish_transforms(odom_frame) && publish_maps());
}

asio::awaitable<void> RobotPublisher::publish_transforms(const std::string& odom_frame) {
    if (!options_.transform) co_return;
    asio::steady_timer timer(co_await asio::this_coro::executor, std::chrono::steady_clock::now());
    for (;;) {
        timer.expires_at(std::max(timer.expiry() + options_.transform_period, std::chrono::steady_clock::now()));
        if (std::get<0>(co_await timer.async_wait(kAwaitTuple))) co_return;
        const auto encoding = session_.publish_encoding();
        if (!T_map_odom_ || !encoding) continue;
        const RosHeader header{stamps_.next(clock_.now(unix_now_ns())), options_.map_frame};
        session_.publish(transforms_, encode_transform(header, odom_frame, *T_map_odom_, *encoding));
        to_send_.notify();
    }
}

asio::awaitable<void> RobotPublisher::publish_maps() {
    if (!options_.map) co_return;
    const auto executor = co_await asio::this_coro::executor;
    MapDownload download(executor, options_.map->http, options_.map->session);
    asio::steady_timer timer(executor);
    std::optional<RosGrid> grid;
    std::chrono::steady_clock::time_point repeated{};
    for (;;) {
        auto newer = co_await download.next();
        if (!newer) note_once("the map cannot be published: " + newer.error().message);
        const bool is_newer = newer && *newer;
        if (is_newer) grid = std::move(**newer);
        const auto now = std::chrono::steady_clock::now();
        if (grid && (is_newer || now >= repeated)) {
            publish_map(*grid);
            repeated = now + options_.map_repeated;
        }
        timer.expires_after(options_.map_period);
        if (std::get<0>(co_await timer.async_wait(kAwaitTuple))) co_return;
    }
}

void RobotPublisher::publish_map(const RosGrid& grid) {
    const auto encoding = session_.publish_encoding();
    if (!encoding) return;
    session_.publish(maps_, encode_grid({clock_.now(unix_now_ns()), options_.map_frame}, grid, *encoding));
    to_send_.notify();
}

void RobotPublisher::note_once(const std::string& text) {
    if (std::exchange(noted_, text) != text) note_(text);
}

} // namespace scanloom::robot
