#pragma once

#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/stationary_phases.hpp"
#include "robot_client/sources/wake_signal.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A laser without odometry that is carried from place to place. While it is stationary the source requests its
/// position from the server and gives the scans taken there (see StationaryPhases). Scans taken while it moves are
/// dropped.
///
/// While a reply is awaited the laser is not read: a laser that cannot wait keeps the newest turns itself and drops
/// older ones (LidarLive). If the server is busy, the request is repeated. The turns of a request are kept here and are
/// given however late the reply is. Once the position is known, the source needs the server no more until the laser is
/// moved.
///
/// Threads: as for LiveSource.
class LocatingSource final : public LiveSource {
public:
    using Report = std::function<void(const std::string&)>;

    /// @param turns            of one laser, with poses in its odometry frame; the origin for a bare lidar
    /// @param first_place      T_map_robot at the start, used if no map exists yet
    /// @param report             receives messages for people
    /// @param retry_after  pause before the request is repeated when the server is busy
    LocatingSource(std::unique_ptr<LiveSource> turns, const Pose2& first_place, Report report,
                   std::chrono::milliseconds retry_after = std::chrono::seconds(1));

    /// Sets the function that locates the robot. Call it before the first next().
    void ask_with(Locate locate) { locate_ = std::move(locate); }

    [[nodiscard]] bool can_wait() const override { return turns_->can_wait(); }
    void resume_after(std::uint64_t scans) override { turns_->resume_after(scans); }

    /// Errors: those of the turns; at the end, if no scan could be given: the newest refusal, or kNotFound if the laser
    ///         was never stationary or stop() was called before a reply arrived.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

private:
    [[nodiscard]] boost::asio::awaitable<void> request_location(SeenPoints seen);
    [[nodiscard]] boost::asio::awaitable<void> wait(WakeSignal::Time until);
    void report_messages();
    [[nodiscard]] Result<std::optional<Observation>> outcome() const;

    std::unique_ptr<LiveSource> turns_;
    StationaryPhases phases_;
    Report report_;
    std::chrono::milliseconds retry_after_;
    Locate locate_;
    bool has_ended_ = false;
    bool is_stopped_ = false;
    WakeSignal wake_; ///< of wait()
};

} // namespace scanloom::robot
