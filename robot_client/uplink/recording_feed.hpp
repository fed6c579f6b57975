#pragma once

#include "robot_client/sources/source.hpp"
#include "robot_client/uplink/feed.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>

namespace scanloom::robot {

/// Computes when each scan of a source is due so that the source runs at `speed` times the pace of its stamps. Speed 0
/// means immediately. The first scan is due immediately. Stamps may be any finite numbers: if the clock of a recording
/// was set, a step forward counts as at most kPauseMax, and a step back of more than kJitterMax counts as zero.
class Pacer {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr double kPauseMax = 600.0; ///< seconds of the source's time
    static constexpr double kJitterMax = 2.0;  ///< seconds of the source's time
    static constexpr double kWaitMax = 1e9;    ///< seconds of the steady clock: thirty years, no overflow

    explicit Pacer(double speed) : speed_(speed) {}

    /// @param stamp  seconds of the source's time
    [[nodiscard]] Time due(double stamp, Time now) {
        if (speed_ <= 0.0) return now;
        if (!start_) start_ = now;
        const double step = stamp - last_stamp_.value_or(stamp);
        if (step >= -kJitterMax) elapsed_ += std::min(step, kPauseMax);
        last_stamp_ = stamp;
        const std::chrono::duration<double> since_start{std::min(elapsed_ / speed_, kWaitMax)};
        return *start_ + std::chrono::duration_cast<Time::duration>(since_start);
    }

private:
    double speed_;
    std::optional<Time> start_;
    std::optional<double> last_stamp_;
    double elapsed_ = 0.0; ///< seconds of the source since its first scan, with long pauses shortened
};

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

    [[nodiscard]] boost::asio::awaitable<Result<>> skip(Intake& intake, std::uint64_t scans);
    [[nodiscard]] boost::asio::awaitable<Result<>> hand_over(Intake& intake);
    [[nodiscard]] boost::asio::awaitable<void> wait_until_due(Intake& intake, Clock::time_point due);

    Source& source_;
    RecordingFeedOptions options_;
    Pacer pacer_;
    std::optional<Clock::time_point> pause_ends_; ///< end of a long pause
    bool ended_ = false;
};

} // namespace scanloom::robot
