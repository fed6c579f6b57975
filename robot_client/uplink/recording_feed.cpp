#include "robot_client/uplink/recording_feed.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

constexpr std::uint64_t kScansBetweenYields = 32; // so that a fast source does not delay acknowledgements

constexpr std::uint64_t kScansOfARobotMax = 1'000'000'000; // three years at ten scans a second

/// Errors: kConflict if the server has more scans than the source.
Result<> check_resume(std::uint64_t stored, std::optional<std::uint64_t> scan_count) {
    if (stored <= scan_count.value_or(kScansOfARobotMax)) return {};
    if (!scan_count) {
        return Error{Errc::kConflict, fmt::format("the server says that it has {} scans of this robot, more than any "
                                                  "robot sends; check --server, or choose another --robot or --session",
                                                  stored)};
    }
    return Error{
        Errc::kConflict,
        fmt::format("the server has {} scans of this robot already, and this run ends with scan {}; let a simulation "
                    "run longer (--scans, --duration), or choose another --robot or --session",
                    stored, *scan_count)};
}

/// Lets other handlers of the thread run first.
asio::awaitable<void> yield() { co_await asio::post(co_await asio::this_coro::executor, asio::use_awaitable); }

} // namespace

RecordingFeed::RecordingFeed(Source& source, RecordingFeedOptions options)
    : source_(source), options_(std::move(options)), pacer_(options_.speed) {}

asio::awaitable<Result<>> RecordingFeed::run(Intake& intake) {
    while (!intake.resumed_after()) co_await intake.wait_for_change();
    if (auto passed = co_await skip(intake, *intake.resumed_after()); !passed) co_return passed;
    co_return co_await hand_over(intake);
}

/// Skips scans that the server has from an earlier run.
asio::awaitable<Result<>> RecordingFeed::skip(Intake& intake, std::uint64_t scans) {
    if (scans == 0) co_return Result<>{};
    if (auto ok = check_resume(scans, source_.scan_count()); !ok) co_return ok;
    options_.on_resume(scans);
    for (std::uint64_t passed = 1; passed <= scans && !intake.is_stopped(); ++passed) {
        auto observation = source_.next();
        if (!observation) co_return observation.error();
        if (passed % kScansBetweenYields == 0) co_await yield();
    }
    co_return Result<>{};
}

asio::awaitable<Result<>> RecordingFeed::hand_over(Intake& intake) {
    std::uint64_t scans_since_yield = 0;
    while (!intake.is_stopped()) {
        if (!intake.has_room()) {
            co_await intake.wait_for_change();
            continue;
        }
        auto next = source_.next();
        if (!next) co_return next.error();
        std::optional<Observation>& observation = *next;
        if (!observation) {
            ended_ = true;
            break;
        }
        co_await wait_until_due(intake, pacer_.due(observation->scan.stamp, Clock::now()));
        if (intake.is_stopped()) break; // this scan is not due yet
        intake.add(std::move(*observation));
        if (++scans_since_yield % kScansBetweenYields == 0) co_await yield();
    }
    co_return Result<>{};
}

asio::awaitable<void> RecordingFeed::wait_until_due(Intake& intake, Clock::time_point due) {
    if (const auto pause = due - Clock::now(); pause > kLongPause) {
        pause_ends_ = due;
        options_.on_long_pause(pause);
    }
    while (!intake.is_stopped() && due > Clock::now()) co_await intake.wait_for_change(due);
    pause_ends_.reset();
}

std::optional<std::chrono::duration<double>> RecordingFeed::next_scan_in() const {
    if (!pause_ends_) return std::nullopt;
    return *pause_ends_ - Clock::now();
}

std::optional<std::string> RecordingFeed::unfinished(std::uint64_t last) const {
    const auto count = source_.scan_count();
    if (!count || ended_) return std::nullopt;
    return fmt::format("after scan {} of {}; what was sent is stored, and the same command sends the rest", last,
                       *count);
}

} // namespace scanloom::robot
