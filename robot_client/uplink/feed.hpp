#pragma once

#include "robot_client/source/source.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::robot {

/// The uplink as a feed sees it: where its scans go, and how far they are.
/// Thread  the uplink's.
class Intake {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Scans of this robot that the server held when it was first reached; nothing before that.
    [[nodiscard]] virtual std::optional<std::uint64_t> resumed_after() const = 0;
    /// Of Welcome; empty before the server was reached.
    [[nodiscard]] virtual const std::string& session_id() const = 0;
    [[nodiscard]] virtual bool has_room() const = 0;
    /// Takes the robot's next scan. Pre: has_room().
    virtual void add(Observation observation) = 0;
    /// @return false where all scans there are may have been sent.
    virtual bool drop_oldest_unsent() = 0;
    /// No more scans are wanted.
    [[nodiscard]] virtual bool is_stopped() const = 0;

    /// Waits until one of these may have changed, or until then, or for wake(). One coroutine at a time.
    [[nodiscard]] virtual boost::asio::awaitable<void> news(Time until = Time::max()) = 0;
    virtual void wake() = 0;

protected:
    ~Intake() = default;
};

/// What hands scans to an uplink. It outlives the uplink's run.
/// Thread  the uplink's.
class Feed {
public:
    virtual ~Feed() = default;

    /// Hands scans over until there are no more, or the intake is stopped.
    /// Errors  end the uplink, once what was handed over is acknowledged.
    [[nodiscard]] virtual boost::asio::awaitable<Result<>> run(Intake& intake) = 0;

    /// The server holds all scans up to `seq`.
    virtual void acknowledged(std::uint64_t seq) { static_cast<void>(seq); }

    /// Scans there will be in the end; nothing where that is not known.
    [[nodiscard]] virtual std::optional<std::uint64_t> scan_count() const { return std::nullopt; }
    /// Whether nothing is taken any more, though some may have to be handed over still.
    [[nodiscard]] virtual bool has_ended() const { return false; }
    /// Scans that were taken and not handed over yet.
    [[nodiscard]] virtual std::uint64_t waiting() const { return 0; }
    /// Scans that were taken and are lost, for want of room.
    [[nodiscard]] virtual std::uint64_t dropped() const { return 0; }
    /// How long nothing will be handed over, in a long pause only.
    [[nodiscard]] virtual std::optional<std::chrono::duration<double>> next_scan_in() const { return std::nullopt; }
    /// Why it counts as unfinished when it was stopped after scan `last`; nothing if it does not.
    [[nodiscard]] virtual std::optional<std::string> unfinished(std::uint64_t last) const {
        static_cast<void>(last);
        return std::nullopt;
    }
};

} // namespace scanloom::robot
