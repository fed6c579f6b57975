#pragma once

#include "robot_client/sources/source.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::robot {

/// The uplink's interface for a feed: it accepts scans and reports their progress.
/// Threads: the uplink's.
class Intake {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Returns how many scans of this robot the server had at the first welcome, or nullopt before it.
    [[nodiscard]] virtual std::optional<std::uint64_t> resumed_after() const = 0;
    /// Returns Welcome::session_id, or an empty string before the first welcome.
    [[nodiscard]] virtual const std::string& session_id() const = 0;
    [[nodiscard]] virtual bool has_room() const = 0;
    /// Adds the robot's next scan. Pre: has_room().
    virtual void add(Observation observation) = 0;
    /// Drops the oldest unsent scan.
    /// @return false if every scan in the buffer may have been sent
    virtual bool drop_oldest_unsent() = 0;
    /// Returns whether the uplink accepts no more scans.
    [[nodiscard]] virtual bool is_stopped() const = 0;

    /// Waits until one of these values may have changed, until the given time, or for wake(). One coroutine at a time.
    [[nodiscard]] virtual boost::asio::awaitable<void> wait_for_change(Time until = Time::max()) = 0;
    virtual void wake() = 0;

protected:
    ~Intake() = default;
};

/// Hands scans to an uplink. It must outlive the uplink's run.
/// Threads: the uplink's.
class Feed {
public:
    virtual ~Feed() = default;

    /// Hands scans over until there are no more or the intake is stopped.
    /// Errors: end the uplink once the scans handed over are acknowledged.
    [[nodiscard]] virtual boost::asio::awaitable<Result<>> run(Intake& intake) = 0;

    /// Notifies the feed that the server has stored all scans up to `seq`.
    virtual void acknowledged(std::uint64_t seq) { static_cast<void>(seq); }

    /// Returns the total number of scans, or nullopt if it is not known.
    [[nodiscard]] virtual std::optional<std::uint64_t> scan_count() const { return std::nullopt; }
    /// Returns whether the source has ended. Scans taken before may still have to be handed over.
    [[nodiscard]] virtual bool has_ended() const { return false; }
    /// Returns the number of scans taken and not handed over yet.
    [[nodiscard]] virtual std::uint64_t waiting() const { return 0; }
    /// Returns the number of scans taken and lost for lack of room.
    [[nodiscard]] virtual std::uint64_t dropped() const { return 0; }
    /// Returns the time until the next scan, only during a long pause.
    [[nodiscard]] virtual std::optional<std::chrono::duration<double>> next_scan_in() const { return std::nullopt; }
    /// Returns why the feed counts as unfinished if it was stopped after scan `last`, or nullopt if it does not.
    [[nodiscard]] virtual std::optional<std::string> unfinished(std::uint64_t last) const {
        static_cast<void>(last);
        return std::nullopt;
    }
};

} // namespace scanloom::robot
