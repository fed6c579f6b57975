#pragma once

#include "robot_client/source/source.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A source whose scans arrive at their own time: a sensor, or a robot that waits for replies. Its scans cannot be
/// obtained again.
///
/// Every scan and sensor keeps common/scan/limits.hpp, as for Source.
/// Threads: that of the executor which awaits next().
class LiveSource {
public:
    virtual ~LiveSource() = default;

    /// Waits for the next scan and returns it, or nullopt when there are no more.
    /// Errors: the sensor's, if it cannot be read any more.
    [[nodiscard]] virtual boost::asio::awaitable<Result<std::optional<Observation>>> next() = 0;

    /// Returns whether the source's time stands still between calls of next(), as in a simulation. Then waiting loses
    /// nothing.
    [[nodiscard]] virtual bool can_wait() const { return false; }
    /// Sets the number of this source's scans that the server has from earlier runs. Only if can_wait(), before the
    /// first next().
    virtual void resume_after(std::uint64_t scans) { static_cast<void>(scans); }

    /// Ends the source: a pending next() returns soon, and later calls return nullopt, or an error if no scan could be
    /// obtained.
    virtual void stop() = 0;

    /// Returns a few words for people about the source, in addition to its scans; may be empty.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::robot
