#include "robot_client/client/worker.hpp"

#include "robot_client/client/checks.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;
using std::chrono::milliseconds;

namespace {

/// Scans that were posted and not yet taken by the client's thread, which takes them at once unless the spool's disk
/// does not respond.
constexpr std::size_t kHandedOverMax = 1024;

constexpr milliseconds kTimeoutMax = std::chrono::hours(24 * 365);

/// How late the client's thread may be, because its disk may not respond.
constexpr milliseconds kGrace{1000};

/// How often to check for changes that are not signalled: dropped scans, and spooled scans that are already stored.
constexpr milliseconds kPollPeriod{100};

} // namespace

void PushedSource::push(Observation observation) {
    scans_.push_back(std::move(observation));
    added_.notify();
}

asio::awaitable<Result<std::optional<Observation>>> PushedSource::next() {
    while (scans_.empty() && !stopped_) co_await added_.wait();
    if (scans_.empty()) co_return std::optional<Observation>{};
    std::optional<Observation> first(std::move(scans_.front()));
    scans_.pop_front();
    co_return first;
}

void PushedSource::stop() {
    stopped_ = true;
    added_.notify();
}

Client::Worker::Timeout::Timeout(milliseconds given)
    : length(std::clamp(given, milliseconds(0), kTimeoutMax)), until(Clock::now() + length) {}

Client::Worker::Worker(UplinkOptions uplink, std::unique_ptr<Spool> spool, LiveFeedOptions feed,
                       std::function<void(const Location&)> on_correction)
    : feed_(source_, std::move(spool), std::move(feed)),
      uplink_(io_, with_corrections(std::move(uplink), std::move(on_correction)), feed_),
      ended_(asio::co_spawn(io_, run(), asio::use_future)), thread_([this] { io_.run(); }) {}

Client::Worker::~Worker() {
    io_.stop();
    thread_.join();
}

/// Keeps the newest correction for transform(), and passes each one to the client's owner.
UplinkOptions Client::Worker::with_corrections(UplinkOptions uplink, std::function<void(const Location&)> passed_to) {
    uplink.protocol.on_correction = [this, passed_to = std::move(passed_to)](const wire::Correction& correction) {
        const Location location = location_of(correction);
        {
            const std::lock_guard lock(mutex_);
            transform_ = location;
            if (location.state == LocalizationState::kUnlocated) transform_.reset();
        }
        if (passed_to) passed_to(location);
    };
    return uplink;
}

std::optional<Location> Client::Worker::transform() {
    const std::lock_guard lock(mutex_);
    return transform_;
}

asio::awaitable<void> Client::Worker::run() {
    const Result<> outcome = co_await uplink_.run();
    {
        const std::lock_guard lock(mutex_);
        outcome_ = outcome ? Error{Errc::kGone, "the client was closed"} : outcome.error();
    }
    uplink_.change_signal().notify();
}

std::optional<Error> Client::Worker::failure() {
    const std::lock_guard lock(mutex_);
    return outcome_;
}

// Scans ---------------------------------------------------------------------------------------------------------------

Result<> Client::Worker::push(Observation observation) {
    const std::lock_guard lock(mutex_); // every scan accepted before close() is posted before the source's end
    if (outcome_) return *outcome_;
    if (is_closing_) return Error{Errc::kGone, "the client is being closed"};
    if (posted_.fetch_add(1) >= kHandedOverMax) {
        --posted_;
        return Error{
            Errc::kOverloaded,
            fmt::format("{} scans wait to be taken up; the disk of the spool may stand still", kHandedOverMax)};
    }
    asio::post(io_, [this, observation = std::move(observation)]() mutable {
        source_.push(std::move(observation));
        ++handed_over_;
        --posted_;
    });
    return {};
}

Result<> Client::Worker::flush(milliseconds length) {
    const Timeout timeout(length);
    return wait_for(until_stored(timeout), timeout);
}

Result<> Client::Worker::close(milliseconds length) {
    const Timeout timeout(length);
    auto flushed = wait_for(until_stored(timeout), timeout);
    if (!flushed && flushed.error().code != Errc::kOverloaded) return flushed;
    {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(is_closing_, true)) asio::post(io_, [this] { source_.stop(); });
    }
    if (ended_.wait_until(timeout.until) != std::future_status::ready) {
        return Error{Errc::kTimeout, fmt::format("the server did not close the link within {:g} s",
                                                 std::chrono::duration<double>(timeout.length).count())};
    }
    if (auto failed = failure(); failed && failed->code != Errc::kGone) return *failed;
    return flushed;
}

std::uint64_t Client::Worker::count_pending(ScanState state) const {
    const UplinkStatus now = uplink_.status();
    const std::uint64_t done = state == ScanState::kStored ? now.acknowledged : std::min(uplink_.applied(), now.last);
    return source_.waiting() + now.waiting + now.last - done;
}

asio::awaitable<Result<>> Client::Worker::until_all_reach(ScanState state, Timeout timeout) {
    const std::uint64_t handed_over = handed_over_;
    const std::uint64_t dropped = uplink_.status().dropped;
    for (;;) {
        // Scans are processed in order: when no more remain than were added later, all earlier ones are done. Which
        // scans were dropped is unknown; counting all of them as later ones only makes the wait longer, by as many
        // scans.
        const std::uint64_t left = count_pending(state);
        const std::uint64_t newer = handed_over_ - handed_over;
        if (left == 0 || left + (uplink_.status().dropped - dropped) <= newer) co_return Result<>{};
        const auto what = fmt::format("{} {} not {}", left, left == 1 ? "scan was" : "scans were",
                                      state == ScanState::kStored ? "stored" : "in the maps");
        if (const auto why = reason_to_stop_waiting(what, timeout)) co_return *why;
        co_await uplink_.change_signal().wait(std::min(timeout.until, Clock::now() + kPollPeriod));
    }
}

asio::awaitable<Result<>> Client::Worker::until_stored(Timeout timeout) {
    const Result<> stored = co_await until_all_reach(ScanState::kStored, timeout);
    if (!stored) co_return stored;
    const std::uint64_t dropped = uplink_.status().dropped;
    const std::uint64_t lost = dropped - std::exchange(dropped_reported_, dropped);
    if (lost == 0) co_return Result<>{};
    co_return Error{Errc::kOverloaded,
                    fmt::format("{} scans were dropped for want of room and are lost, the others are stored; give a "
                                "larger memory_bytes_max, or a spool",
                                lost)};
}

// Questions -----------------------------------------------------------------------------------------------------------

Result<link::Reply> Client::Worker::ask(link::Request request, milliseconds length) {
    if (auto ok = check(request); !ok) return ok.error();
    const Timeout timeout(length);
    return wait_for(until_answered(std::move(request), timeout), timeout);
}

asio::awaitable<Result<link::Reply>> Client::Worker::until_answered(link::Request request, Timeout timeout) {
    const Result<> applied = co_await until_all_reach(ScanState::kInMaps, timeout);
    if (!applied) co_return applied.error();
    const auto reply = std::make_shared<std::optional<link::Reply>>();
    const link::Answered answered = [reply](const link::Reply& got) { reply->emplace(got); };
    auto id = uplink_.ask(request, answered);
    while (!id) {
        if (const auto why = reason_to_stop_waiting("too many questions were open", timeout)) co_return *why;
        co_await uplink_.change_signal().wait(timeout.until);
        id = uplink_.ask(request, answered);
    }
    while (!*reply) {
        if (const auto why = reason_to_stop_waiting("the server did not answer", timeout)) {
            uplink_.abandon(*id);
            co_return *why;
        }
        co_await uplink_.change_signal().wait(timeout.until);
    }
    co_return **reply;
}

// Waiting -------------------------------------------------------------------------------------------------------------

std::optional<Error> Client::Worker::reason_to_stop_waiting(std::string_view what, const Timeout& timeout) {
    if (auto failed = failure()) return failed;
    if (Clock::now() < timeout.until) return std::nullopt;
    return Error{Errc::kTimeout,
                 fmt::format("{} within {:g} s{}", what, std::chrono::duration<double>(timeout.length).count(),
                             uplink_.status().is_linked ? "" : ": " + uplink_.what_is_wrong())};
}

template <class Value>
Result<Value> Client::Worker::wait_for(asio::awaitable<Result<Value>> coroutine, const Timeout& timeout) {
    auto done = asio::co_spawn(io_, std::move(coroutine), asio::use_future);
    if (done.wait_until(timeout.until + kGrace) == std::future_status::ready) return done.get();
    return failure().value_or(
        Error{Errc::kTimeout, "the client's thread stands still; the disk of its spool may, too"});
}

ClientStatus Client::Worker::status() {
    auto asked =
        asio::post(io_, asio::use_future([this] {
                       const UplinkStatus now = uplink_.status();
                       return ClientStatus{now.acknowledged, count_pending(ScanState::kStored) + posted_.load(),
                                           now.dropped, now.bytes, now.is_linked};
                   }));
    return asked.get();
}

} // namespace scanloom::robot
