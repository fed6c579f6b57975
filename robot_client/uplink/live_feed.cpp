#include "robot_client/uplink/live_feed.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <fmt/format.h>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

LiveFeed::LiveFeed(LiveSource& source, std::unique_ptr<Spool> spool, LiveFeedOptions options)
    : source_(source), spool_(std::move(spool)), options_(std::move(options)) {}

asio::awaitable<Result<>> LiveFeed::run(Intake& intake) {
    co_await (take(intake) || hand_over(intake));
    co_return outcome_;
}

/// Ends only when cancelled: hand_over() ends the run.
asio::awaitable<void> LiveFeed::take(Intake& intake) {
    if (source_.can_wait()) {
        while (!intake.resumed_after()) co_await room_.wait();
        source_.resume_after(*intake.resumed_after());
    }
    while (!ended_) {
        if (source_.can_wait()) co_await wait_for_room(intake);
        auto next = co_await source_.next();
        if (!next) {
            outcome_ = next.error();
            ended_ = true;
        } else if (!*next) {
            ended_ = true;
        } else {
            keep(intake, std::move(**next));
        }
        intake.wake();
    }
    for (;;) co_await room_.wait();
}

asio::awaitable<void> LiveFeed::wait_for_room(Intake& intake) {
    while (!intake.has_room() && !intake.is_stopped()) co_await room_.wait();
}

void LiveFeed::keep(Intake& intake, Observation observation) {
    if (!spool_ || spool_given_up_) return keep_in_memory(intake, std::move(observation));
    const auto kept = spool_->append(observation);
    if (kept) return;
    if (!std::exchange(spool_reported_, true)) {
        options_.on_message(fmt::format("{}; scans are held in memory only, or dropped while others wait in the spool",
                                        kept.error().message));
    }
    // Scans are sent in the order in which they were taken. A scan that bypasses the spool would break its numbering,
    // so this program cannot return to the spool.
    spool_given_up_ = spool_->waiting() == 0;
    if (spool_given_up_) return keep_in_memory(intake, std::move(observation));
    ++dropped_;
}

void LiveFeed::keep_in_memory(Intake& intake, Observation observation) {
    if (!intake.has_room() && !std::exchange(dropping_reported_, true)) {
        options_.on_message(fmt::format("the memory for scans that are not acknowledged is full: the {} are dropped; "
                                        "--spool keeps them on disk",
                                        options_.when_full == WhenFull::kDropOldest ? "oldest unsent" : "newest"));
    }
    while (!intake.has_room()) { // the oldest scan may be smaller than the new one
        ++dropped_;
        if (options_.when_full == WhenFull::kDropNewest || !intake.drop_oldest_unsent()) return;
    }
    intake.add(std::move(observation));
}

asio::awaitable<void> LiveFeed::hand_over(Intake& intake) {
    bool stopped = false;
    bool resumed = false;
    for (;;) {
        if (intake.resumed_after() && !std::exchange(resumed, true) && *intake.resumed_after() > 0) {
            options_.on_resume(*intake.resumed_after());
        }
        if (intake.is_stopped() && !std::exchange(stopped, true)) source_.stop();
        if (spool_ && !spool_given_up_ && intake.resumed_after()) {
            if (auto ok = hand_over_from_spool(intake); !ok) {
                outcome_ = ok;
                co_return;
            }
        }
        if (ended_ && waiting() == 0) {
            if (spool_ && begun_)
                spool_->remove_acknowledged(); // files acknowledged before; acknowledged() removes the rest
            co_return;
        }
        room_.notify();
        co_await intake.wait_for_change();
    }
}

Result<> LiveFeed::hand_over_from_spool(Intake& intake) {
    if (!begun_) {
        if (auto ok = spool_->begin(intake.session_id(), *intake.resumed_after()); !ok) {
            const bool may_go_on = ok.error().code == Errc::kStoreFailed && spool_->waiting() == 0;
            if (!may_go_on) return ok;
            options_.on_message(ok.error().message + "; scans are held in memory only");
            spool_reported_ = spool_given_up_ = true;
            return {};
        }
        begun_ = true;
    }
    if (auto ok = spool_->follow(intake.session_id()); !ok) return ok;
    while (intake.has_room()) {
        auto next = spool_->next();
        if (!next) return next.error();
        if (!*next) break;
        intake.add(std::move(**next));
    }
    return {};
}

void LiveFeed::acknowledged(std::uint64_t seq) {
    if (!spool_ || !begun_) return;
    spool_->acknowledge(seq);
    if (ended_) spool_->remove_acknowledged();
}

std::optional<std::string> LiveFeed::unfinished(std::uint64_t) const {
    if (waiting() == 0) return std::nullopt;
    return fmt::format("with {} scans in the spool {}; the same command sends them", waiting(),
                       spool_->directory().string());
}

Result<std::unique_ptr<Spool>> open_spool_of(const std::string& session, const std::string& robot, SpoolOptions options,
                                             const std::function<void(const std::string&)>& on_message) {
    if (options.directory.empty()) return std::unique_ptr<Spool>{};
    options.directory /= fmt::format("{}.{}", session, robot);
    return Spool::open(std::move(options), on_message);
}

} // namespace scanloom::robot
