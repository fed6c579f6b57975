#pragma once

#include "robot_client/client/client.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "robot_client/uplink/live_feed.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace scanloom::robot {

/// A source of the scans that its owner pushes.
/// Threads: as for LiveSource, including push() and stop().
class PushedSource final : public LiveSource {
public:
    void push(Observation observation);

    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    /// Ends the source after the scans that were pushed before.
    void stop() override;

    [[nodiscard]] std::size_t waiting() const noexcept { return scans_.size(); }

private:
    std::deque<Observation> scans_;
    bool stopped_ = false;
    WakeSignal added_;
};

/// Returns a correction of the server as a location.
[[nodiscard]] inline Location location_of(const wire::Correction& correction) {
    return {.T_map_odom = correction.T_map_odom,
            .inlier_ratio = correction.explained,
            .position_sigma = correction.position_sigma,
            .yaw_sigma = correction.yaw_sigma,
            .revision = correction.revision,
            .state = correction.state,
            .explained = correction.explained,
            .mount_yaw_error = correction.mount_yaw_error};
}

/// Runs the uplink on a thread of its own.
///
/// Each waiting call runs a coroutine on that thread. The coroutine ends by itself when the caller's timeout has
/// passed, so none remains after its caller has returned.
/// Threads: any thread, several at a time. Private functions run on the worker's own thread unless their comment says
///          otherwise.
class Client::Worker {
public:
    /// @param on_correction  as ClientOptions::on_correction
    Worker(UplinkOptions uplink, std::unique_ptr<Spool> spool, LiveFeedOptions feed,
           std::function<void(const Location&)> on_correction);
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    [[nodiscard]] Result<> push(Observation observation);
    [[nodiscard]] Result<> flush(std::chrono::milliseconds timeout);
    [[nodiscard]] Result<> close(std::chrono::milliseconds timeout);
    /// Sends a request and waits for the reply, which may be a refusal by the server.
    /// Errors: kInvalidField or kTooLarge if a value would end the link; kTimeout; the error that ended the client.
    [[nodiscard]] Result<link::Reply> ask(link::Request request, std::chrono::milliseconds timeout);
    [[nodiscard]] ClientStatus status();
    [[nodiscard]] std::optional<Location> transform();

private:
    using Clock = std::chrono::steady_clock;

    /// How long a caller waits.
    struct Timeout {
        explicit Timeout(std::chrono::milliseconds length);

        std::chrono::milliseconds length;
        Clock::time_point until;
    };

    /// The state that a caller waits for scans to reach.
    enum class ScanState { kStored, kInMaps };

    [[nodiscard]] UplinkOptions with_corrections(UplinkOptions uplink, std::function<void(const Location&)> passed_to);
    [[nodiscard]] boost::asio::awaitable<void> run();
    /// Waits for the scans that were handed over before. Dropped scans count as done.
    [[nodiscard]] boost::asio::awaitable<Result<>> until_all_reach(ScanState state, Timeout timeout);
    [[nodiscard]] boost::asio::awaitable<Result<>> until_stored(Timeout timeout);
    [[nodiscard]] boost::asio::awaitable<Result<link::Reply>> until_answered(link::Request request, Timeout timeout);
    [[nodiscard]] std::uint64_t count_pending(ScanState state) const;
    /// Returns the error to stop waiting with if the client has ended or the timeout has passed, else nullopt.
    [[nodiscard]] std::optional<Error> reason_to_stop_waiting(std::string_view what, const Timeout& timeout);

    /// Waits for a coroutine.
    /// Threads: the caller's.
    template <class Value>
    [[nodiscard]] Result<Value> wait_for(boost::asio::awaitable<Result<Value>> coroutine, const Timeout& timeout);
    /// Returns the error that the client has ended with, if it has.
    /// Threads: any thread.
    [[nodiscard]] std::optional<Error> failure();

    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    PushedSource source_;
    LiveFeed feed_;
    std::mutex mutex_;
    Uplink uplink_;
    std::uint64_t handed_over_ = 0;      ///< scans, given to source_
    std::uint64_t dropped_reported_ = 0; ///< scans that flush() has reported
    std::atomic<std::size_t> posted_ = 0;
    std::optional<Location> transform_; ///< guarded by mutex_
    std::optional<Error> outcome_;      ///< guarded by mutex_
    bool is_closing_ = false;           ///< guarded by mutex_
    std::future<void> ended_;
    std::thread thread_; // last: it uses the others
};

} // namespace scanloom::robot
