#pragma once

#include "robot_client/source/source.hpp"
#include "robot_client/uplink/feed.hpp"
#include "robot_client/uplink/pacer.hpp"

#include <functional>

namespace scanloom::robot {

/// A pause between two scans that is reported to people.
inline constexpr std::chrono::seconds kLongPause{60};

struct RecordingFeedOptions {
    double speed = 0.0; ///< multiple of the source's own pace; 0 = as fast as the server accepts scans
    /// Called before the first scan is sent with the number of scans that the server has from earlier runs, if there
    /// are any.
    std::function<void(std::uint64_t)> on_resume = [](std::uint64_t) {};
    /// Called with the length of a pause, only if the next scan is due in more than kLongPause.
    std::function<void(std::chrono::duration<double>)> on_long_pause = [](std::chrono::duration<double>) {};
};

/// Feeds scans that can be read again. It skips the scans that the server has from earlier runs, keeps the pace, and
/// waits while there is no room.
/// Errors of run(): kConflict if the server has more scans than the source; those of the source.
class RecordingFeed final : public Feed {
public:
    RecordingFeed(Source& source, RecordingFeedOptions options);

    [[nodiscard]] boost::asio::awaitable<Result<>> run(Intake& intake) override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return source_.scan_count(); }
    [[nodiscard]] std::optional<std::chrono::duration<double>> next_scan_in() const override;
    [[nodiscard]] std::optional<std::string> unfinished(std::uint64_t last) const override;

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] boost::asio::awaitable<Result<>> pass_over(Intake& intake, std::uint64_t scans);
    [[nodiscard]] boost::asio::awaitable<Result<>> hand_over(Intake& intake);
    [[nodiscard]] boost::asio::awaitable<void> wait_until_due(Intake& intake, Clock::time_point due);

    Source& source_;
    RecordingFeedOptions options_;
    Pacer pacer_;
    std::optional<Clock::time_point> pause_ends_; ///< end of a long pause
    bool ended_ = false;
};

} // namespace scanloom::robot
