#pragma once

#include "robot_client/source/source.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::robot {

/// Where scans come from that come when they come: a sensor, or a robot that waits for answers. What was taken once
/// cannot be had again.
///
/// Post    as of Source.
/// Thread  that of the executor which awaits next().
class LiveSource {
public:
    virtual ~LiveSource() = default;

    /// The next scan, once there is one; nothing when there will be no more.
    /// Errors  a sensor that cannot be read any more.
    [[nodiscard]] virtual boost::asio::awaitable<Result<std::optional<Observation>>> next() = 0;

    /// Whether time stands still for it while next() is not called, as in a simulation: nothing is lost by waiting
    /// then.
    [[nodiscard]] virtual bool can_wait() const { return false; }
    /// The server holds so many of its scans from earlier runs. Only where it can wait, before the first next().
    virtual void resume_after(std::uint64_t scans) { static_cast<void>(scans); }

    /// No more is wanted: next() comes to its end soon, and after it gives nothing, or an error where nothing could be
    /// had at all.
    virtual void stop() = 0;

    /// What people should know of it beside its scans, a few words; empty: nothing.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::robot
