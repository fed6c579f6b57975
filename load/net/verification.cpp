#include "load/net/verification.hpp"

#include "common/net/await_tuple.hpp"
#include "load/core/figure_text.hpp"
#include "load/net/server_api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr Micros kTimeout = 60 * kSecond;
constexpr std::chrono::milliseconds kLookPeriod{2};

/// Sends each scan in its own frame: maps do not depend on how scans are grouped.
Workload without_schedule(Workload workload) {
    workload.schedule.reset();
    workload.batch = 1;
    return workload;
}

} // namespace

ReferenceSession::ReferenceSession(asio::io_context& io, std::string name, const RunClock& clock,
                                   const Workload& workload, const RobotLinkOptions& link)
    : io_(io), clock_(clock), workload_(without_schedule(workload)),
      robot_(RobotPlan{0, std::move(name), "r0", 0}, {io_, clock_, workload_, link, *figures_, troubles_}) {
    robot_.start();
}

ReferenceSession::~ReferenceSession() { robot_.stop(); }

asio::awaitable<Result<>> ReferenceSession::stream_to(std::uint64_t scans) {
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

namespace {

constexpr std::size_t kReportEvery = 50;

void report_progress(const ReportProgress& report, std::string_view what, std::size_t done, std::size_t of) {
    if (done % kReportEvery == 0) report(fmt::format("{} {} of {} sessions", what, grouped(done), grouped(of)));
}

std::uint64_t scans_of(const ExpectedSession& session) { return session.robots.front().scans; }

} // namespace

asio::awaitable<void> verify_counts(net::HttpConnection& http, const std::vector<ExpectedSession>& sessions,
                                    ReportProgress report, Evidence& evidence) {
    for (std::size_t i = 0; i < sessions.size(); ++i) {
        report_progress(report, "counting the scans of", i, sessions.size());
        const auto found = co_await find_session(http, sessions[i].name);
        if (!found) {
            evidence.failures.push_back(found.error().message);
            if (found.error().code == Errc::kUnreachable || found.error().code == Errc::kTimeout) co_return;
            continue;
        }
        evidence.scans_in_sessions += found->scans;
        if (auto wrong = contradiction(sessions[i], *found)) evidence.contradictions.push_back(std::move(*wrong));
    }
}

asio::awaitable<void> verify_digests(net::HttpConnection& http, std::vector<ExpectedSession> sessions,
                                     std::string reference_name, ReferenceSession& reference, ReportProgress report,
                                     Evidence& evidence) {
    std::erase_if(sessions,
                  [](const ExpectedSession& session) { return scans_of(session) == 0; }); // has no maps to compare
    std::ranges::sort(sessions, {}, scans_of);
    std::uint64_t streamed = 0;
    std::string right;
    for (std::size_t i = 0; i < sessions.size(); ++i) {
        report_progress(report, "comparing the maps of", i, sessions.size());
        if (const std::uint64_t scans = scans_of(sessions[i]); scans > streamed) {
            const auto done = co_await reference.stream_to(scans);
            if (!done) co_return evidence.failures.push_back(done.error().message);
            auto digest = co_await digest_of(http, reference_name);
            if (!digest) co_return evidence.failures.push_back(digest.error().message);
            right = std::move(*digest);
            streamed = scans;
        }
        const auto digest = co_await digest_of(http, sessions[i].name);
        if (!digest) co_return evidence.failures.push_back(digest.error().message);
        if (*digest == right) {
            ++evidence.digests_equal;
        } else {
            evidence.contradictions.push_back(
                fmt::format("the maps of session {} differ from those of an undisturbed session with its {} scans",
                            sessions[i].name, grouped(streamed)));
        }
    }
}

} // namespace scanloom::load
