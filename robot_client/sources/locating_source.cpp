#include "robot_client/sources/locating_source.hpp"

#include "common/error/error.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <fmt/format.h>

#include <cassert>
#include <utility>
#include <variant>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

/// Returns whether the server may locate the robot if it is request again.
bool may_pass(Errc code) { return code == Errc::kOverloaded || code == Errc::kShuttingDown; }

} // namespace

LocatingSource::LocatingSource(std::unique_ptr<LiveSource> turns, const Pose2& first_place, Report report,
                               std::chrono::milliseconds retry_after)
    : turns_(std::move(turns)), phases_(first_place), report_(std::move(report)), retry_after_(retry_after) {}

asio::awaitable<Result<std::optional<Observation>>> LocatingSource::next() {
    assert(locate_);
    for (;;) {
        if (auto turn = phases_.take()) co_return std::move(turn);
        if (has_ended_) co_return outcome();
        auto question = is_stopped_ ? std::nullopt : phases_.question();
        if (question) {
            co_await request_location(std::move(*question));
            report_messages();
            continue;
        }
        auto turn = co_await turns_->next();
        if (!turn) co_return turn.error();
        if (*turn) {
            phases_.add(std::move(**turn));
        } else {
            phases_.end();
            has_ended_ = true;
        }
        report_messages();
    }
}

/// Repeats the request until the server has searched the map. A busy server says nothing about the place.
asio::awaitable<void> LocatingSource::request_location(SeenPoints seen) {
    const auto points = seen.points();
    const Point2 from = seen.from();
    bool is_reported = false;
    while (!is_stopped_) {
        auto request = points; // a named variable, because g++ 12 destroys such temporaries twice
        const auto answer = co_await (locate_(std::move(request), from) || wait(WakeSignal::Time::max()));
        if (answer.index() != 0) continue;
        const Result<LocateResult>& located = std::get<0>(answer);
        if (located || !may_pass(located.error().code)) {
            phases_.answer(located);
            co_return;
        }
        if (!std::exchange(is_reported, true))
            report_(further(located.error().message, "keep the lidar in place; retrying"));
        co_await wait(std::chrono::steady_clock::now() + retry_after_);
    }
}

/// Waits until the given time or until stop().
asio::awaitable<void> LocatingSource::wait(WakeSignal::Time until) {
    if (!is_stopped_) co_await wake_.wait(until);
}

void LocatingSource::stop() {
    is_stopped_ = true;
    wake_.notify();
    turns_->stop();
}

void LocatingSource::report_messages() {
    for (const auto& sentence : phases_.take_messages()) report_(sentence);
}

Result<std::optional<Observation>> LocatingSource::outcome() const {
    if (phases_.given() > 0 || phases_.dropped() == 0) return std::optional<Observation>{};
    if (phases_.refusal()) return prefixed("no scan was sent: ", *phases_.refusal());
    if (is_stopped_) {
        return Error{Errc::kNotFound,
                     "no scan was sent: the run was stopped before the server had localized the lidar"};
    }
    return Error{Errc::kNotFound,
                 fmt::format("no scan was sent: among {} no {} in a row were similar and showed enough; place the "
                             "lidar where it can see walls, and keep people away from it",
                             counted(phases_.dropped(), "turn"), StationaryPhases::kTurnsAlike)};
}

std::string LocatingSource::remarks() const {
    const std::string of_turns = turns_->remarks();
    return fmt::format("{}{}carried {}, {} while carried or not localized", of_turns, of_turns.empty() ? "" : ", ",
                       counted(phases_.carried(), "time"), counted(phases_.dropped(), "turn"));
}

} // namespace scanloom::robot
