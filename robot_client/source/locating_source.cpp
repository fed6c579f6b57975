#include "robot_client/source/locating_source.hpp"

#include "common/error/further.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/source/counted.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <cassert>
#include <utility>
#include <variant>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

using Time = std::chrono::steady_clock::time_point;

/// Returns whether the server may locate the robot if it is asked again.
bool may_pass(Errc code) { return code == Errc::kOverloaded || code == Errc::kShuttingDown; }

/// Makes a timer known while it exists. It may be destroyed before or after the source.
class Shown {
public:
    Shown(std::shared_ptr<asio::steady_timer*> place, asio::steady_timer& timer) : place_(std::move(place)) {
        *place_ = &timer;
    }
    Shown(const Shown&) = delete;
    Shown& operator=(const Shown&) = delete;
    ~Shown() { *place_ = nullptr; }

private:
    std::shared_ptr<asio::steady_timer*> place_;
};

} // namespace

LocatingSource::LocatingSource(std::unique_ptr<LiveSource> turns, const Pose2& first_place, Tell tell,
                               std::chrono::milliseconds ask_again_after)
    : turns_(std::move(turns)), halts_(first_place), tell_(std::move(tell)), ask_again_after_(ask_again_after) {}

asio::awaitable<Result<std::optional<Observation>>> LocatingSource::next() {
    assert(locate_);
    for (;;) {
        if (auto turn = halts_.take()) co_return std::move(turn);
        if (has_ended_) co_return outcome();
        auto question = is_stopped_ ? std::nullopt : halts_.question();
        if (question) {
            co_await ask(std::move(*question));
            tell_news();
            continue;
        }
        auto turn = co_await turns_->next();
        if (!turn) co_return turn.error();
        if (*turn) {
            halts_.add(std::move(**turn));
        } else {
            halts_.end();
            has_ended_ = true;
        }
        tell_news();
    }
}

/// Repeats the request until the server has searched the map. A busy server says nothing about the place.
asio::awaitable<void> LocatingSource::ask(SeenPoints seen) {
    const auto points = seen.points();
    const Point2 from = seen.from();
    bool is_told = false;
    while (!is_stopped_) {
        auto asked = points; // a named variable, because g++ 12 destroys such temporaries twice
        const auto answer = co_await (locate_(std::move(asked), from) || wait(Time::max()));
        if (answer.index() != 0) continue;
        const Result<Located>& located = std::get<0>(answer);
        if (located || !may_pass(located.error().code)) {
            halts_.answer(located);
            co_return;
        }
        if (!std::exchange(is_told, true))
            tell_(further(located.error().message, "the lidar is to stay; asking again"));
        co_await wait(std::chrono::steady_clock::now() + ask_again_after_);
    }
}

/// Waits until the given time or until stop().
asio::awaitable<void> LocatingSource::wait(Time until) {
    if (is_stopped_) co_return;
    asio::steady_timer timer(co_await asio::this_coro::executor, until);
    const Shown shown(awaiting_, timer);
    co_await timer.async_wait(kAwaitTuple);
}

void LocatingSource::stop() {
    is_stopped_ = true;
    if (*awaiting_ != nullptr) (*awaiting_)->cancel();
    turns_->stop();
}

void LocatingSource::tell_news() {
    for (const auto& sentence : halts_.take_news()) tell_(sentence);
}

Result<std::optional<Observation>> LocatingSource::outcome() const {
    if (halts_.given() > 0 || halts_.dropped() == 0) return std::optional<Observation>{};
    if (halts_.refusal()) return prefixed("no scan was sent: ", *halts_.refusal());
    if (is_stopped_) {
        return Error{Errc::kNotFound,
                     "no scan was sent: it was stopped before the server had told where the lidar stands"};
    }
    return Error{
        Errc::kNotFound,
        fmt::format("no scan was sent: of {} no {} in a row were alike and saw enough to tell; let the lidar stand "
                    "where it sees walls, and stay away from it",
                    counted(halts_.dropped(), "turn"), Halts::kTurnsAlike)};
}

std::string LocatingSource::remarks() const {
    const std::string of_turns = turns_->remarks();
    return fmt::format("{}{}carried {}, {} while carried or not located", of_turns, of_turns.empty() ? "" : ", ",
                       counted(halts_.carried(), "time"), counted(halts_.dropped(), "turn"));
}

} // namespace scanloom::robot
