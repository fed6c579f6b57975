#pragma once

#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "robot_client/spool/spool.hpp"
#include "robot_client/uplink/feed.hpp"

#include <functional>
#include <memory>
#include <optional>

namespace scanloom::robot {

struct LiveFeedOptions {
    WhenFull when_full = WhenFull::kDropOldest; ///< without a spool, which has its own setting
    /// Called before the first scan is sent with the number of scans that the server has from earlier runs, if there
    /// are any.
    std::function<void(std::uint64_t)> on_resume = [](std::uint64_t) {};
    /// Receives messages for people, for example that scans are dropped or that the spool cannot be written.
    std::function<void(const std::string&)> on_message = [](const std::string&) {};
};

/// Feeds scans that cannot be obtained again. It takes scans whether or not the server is reachable. With a spool,
/// scans go into it and from there to the uplink when there is room. Without a spool they go into the uplink's memory,
/// and some are dropped when it is full. A source that can wait is not read before the server was reached or while
/// there is no room.
/// Errors of run(): those of the source, once the scans before are handed over; those of the spool.
class LiveFeed final : public Feed {
public:
    /// @param spool  may be null
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
    WakeSignal room_; ///< when there may be room
    Result<> outcome_;
    std::uint64_t dropped_ = 0; ///< not counting those of the spool
    bool dropping_reported_ = false;
    bool spool_reported_ = false;
    bool spool_given_up_ = false;
    bool begun_ = false; ///< Spool::begin() was called
    bool ended_ = false; ///< the source has ended
};

/// Opens the robot's spool, the directory SESSION.ROBOT in SpoolOptions::directory. Returns null if that is empty.
/// @param on_message  receives messages for people
/// Errors: those of Spool::open().
[[nodiscard]] Result<std::unique_ptr<Spool>> open_spool_of(const std::string& session, const std::string& robot,
                                                           SpoolOptions options,
                                                           const std::function<void(const std::string&)>& on_message);

} // namespace scanloom::robot
