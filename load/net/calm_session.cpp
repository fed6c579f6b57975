#include "load/net/calm_session.hpp"

#include "common/net/await_tuple.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr Micros kTimeout = 60 * kSecond;
constexpr std::chrono::milliseconds kLookPeriod{2};

/// Sends each scan in its own frame: maps do not depend on how scans are grouped.
Course in_peace(Course course) {
    course.schedule.reset();
    course.batch = 1;
    return course;
}

} // namespace

CalmSession::CalmSession(asio::io_context& io, std::string name, const RunClock& clock, const Course& course,
                         const RobotLinkOptions& link)
    : io_(io), clock_(clock), course_(in_peace(course)),
      robot_(RobotPlan{0, std::move(name), "r0", 0}, {io_, clock_, course_, link, *figures_, troubles_}) {
    robot_.start();
}

CalmSession::~CalmSession() { robot_.stop(); }

asio::awaitable<Result<>> CalmSession::stream_to(std::uint64_t scans) {
    asio::steady_timer timer(io_);
    std::uint64_t acknowledged = robot_.client().acknowledged();
    Micros progress = clock_.now();
    robot_.due(scans);
    while (robot_.client().acknowledged() < scans) {
        timer.expires_after(kLookPeriod);
        co_await timer.async_wait(kAwaitTuple);
        if (robot_.has_failed()) co_return Error{Errc::kInternal, troubles_.failures.front()};
        robot_.look_after(clock_.now());
        if (std::exchange(acknowledged, robot_.client().acknowledged()) != robot_.client().acknowledged()) {
            progress = clock_.now();
        } else if (clock_.now() > progress + kTimeout) {
            co_return Error{Errc::kTimeout,
                            fmt::format("the undisturbed session accepted no scan for {:g} s", in_seconds(kTimeout))};
        }
    }
    co_return Result<>();
}

} // namespace scanloom::load
