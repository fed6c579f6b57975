#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/source.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// What a driver wants after an event on its line.
struct LidarStep {
    bool has_packet = false;        ///< a complete packet of measurements ended within the bytes
    std::vector<std::uint8_t> send; ///< bytes to write
    /// Replaces the running timeout, which starts now: on_timeout() is called when it is over. 0: no timeout.
    std::optional<std::chrono::milliseconds> timeout;
    std::optional<Error> failure;   ///< the line must be opened again; the message is for people
    std::vector<std::string> notes; ///< for people
};

/// Counts for people about what a lidar has sent.
struct LidarCounts {
    std::uint64_t damaged = 0;  ///< packets
    std::uint64_t turns = 0;    ///< including parts of turns
    std::uint64_t parts = 0;    ///< turns that were cut by a gap
    std::uint64_t gaps = 0;     ///< where packets are missing
    std::uint64_t too_long = 0; ///< turns with more points than a scan may have, which are dropped
};

/// Counts of the scans that were not given.
struct LidarLosses {
    std::uint64_t without_pose = 0;
    std::uint64_t too_many_waiting = 0; ///< dropped because next() was not called in time
};

/// Returns a summary for people: "3 damaged packets, 225 turns, 4 of them cut by 2 gaps", and further losses.
[[nodiscard]] std::string lidar_remarks(const LidarCounts& counts, const LidarLosses& losses);

/// The protocol of one kind of lidar: a state machine that is fed bytes and gives scans without poses. It does no I/O
/// and reads no clock.
///
/// Threads: one at a time.
class LidarDriver {
public:
    virtual ~LidarDriver() = default;

    /// Starts a new stream: the next bytes do not continue the previous ones. Counts continue.
    [[nodiscard]] virtual LidarStep on_open() = 0;

    /// @param bytes    that have arrived, however they are split
    /// @param arrival  Unix seconds
    [[nodiscard]] virtual LidarStep on_bytes(std::span<const std::uint8_t> bytes, double arrival) = 0;

    /// The timeout of the newest step is over.
    [[nodiscard]] virtual LidarStep on_timeout() = 0;

    /// Returns the bytes that end the stream, for the last write before the line is closed.
    [[nodiscard]] virtual std::vector<std::uint8_t> stop_request() const { return {}; }

    /// Returns the next complete scan. Its stamp is Unix time.
    [[nodiscard]] virtual std::optional<Observation> next() = 0;

    /// Returns the sensor with its article, for messages: "an LD06".
    [[nodiscard]] virtual std::string_view title() const = 0;

    [[nodiscard]] virtual LidarCounts counts() const = 0;
};

} // namespace scanloom::robot
