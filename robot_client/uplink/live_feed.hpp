#pragma once

#include "robot_client/source/live_source.hpp"
#include "robot_client/spool/spool.hpp"
#include "robot_client/uplink/bell.hpp"
#include "robot_client/uplink/feed.hpp"

#include <functional>
#include <memory>
#include <optional>

namespace scanloom::robot {

struct LiveFeedOptions {
    WhenFull when_full = WhenFull::kDropOldest; ///< without a spool; that has its own
    /// Hears, before the first scan is sent, how many the server holds from earlier runs; only if there are any.
    std::function<void(std::uint64_t)> on_resume = [](std::uint64_t) {};
    /// Hears sentences for people: that scans are being dropped, that the spool cannot be written.
    std::function<void(const std::string&)> tell = [](const std::string&) {};
};

/// Hands over what cannot be had again. It takes scans whether there is a server or not: into the spool, and from there
/// as there is room; without a spool into the uplink's memory, and drops some where that is full. A source that can
/// wait is asked for nothing before the server was reached, nor while there is no room.
/// Errors of run()  those of the source, once what it gave before is handed over; those of the spool.
class LiveFeed final : public Feed {
public:
    /// `spool` may be null.
    LiveFeed(LiveSource& source, std::unique_ptr<Spool> spool, LiveFeedOptions options);

    [[nodiscard]] boost::asio::awaitable<Result<>> run(Intake& intake) override;
    void acknowledged(std::uint64_t seq) override;
    [[nodiscard]] bool has_ended() const override { return ended_; }
    [[nodiscard]] std::uint64_t waiting() const override { return spool_ ? spool_->waiting() : 0; }
    [[nodiscard]] std::uint64_t dropped() const override { return dropped_ + (spool_ ? spool_->dropped() : 0); }
    [[nodiscard]] std::optional<std::string> unfinished(std::uint64_t last) const override;

private:
    [[nodiscard]] boost::asio::awaitable<void> take(Intake& intake);
    [[nodiscard]] boost::asio::awaitable<void> wait_for_room(Intake& intake);
    void keep(Intake& intake, Observation observation);
    void keep_in_memory(Intake& intake, Observation observation);
    [[nodiscard]] boost::asio::awaitable<void> hand_over(Intake& intake);
    [[nodiscard]] Result<> hand_over_from_spool(Intake& intake);

    LiveSource& source_;
    std::unique_ptr<Spool> spool_;
    LiveFeedOptions options_;
    Bell room_; ///< there may be some
    Result<> outcome_;
    std::uint64_t dropped_ = 0; ///< not by the spool
    bool told_of_dropping_ = false;
    bool told_of_spool_ = false;
    bool spool_given_up_ = false;
    bool begun_ = false; ///< the spool
    bool ended_ = false; ///< the source
};

} // namespace scanloom::robot
