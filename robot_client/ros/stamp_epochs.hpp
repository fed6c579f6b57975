#pragma once

#include "robot_client/ros/messages.hpp"
#include "robot_client/sources/scan_order.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// Divides a recording into epochs: a new one begins where the clock of the robot was set back, or where a simulation
/// began again. Equal stamps of two epochs are different times.
///
/// The messages of a stream, such as a topic, have increasing stamps apart from jitter. The first stream whose stamps
/// fall begins a new epoch; each other one joins it where its own stamps fall. Where stamps continue from before a
/// step, as after a single wrong stamp, the stream returns to the epoch before.
/// Threads: one at a time.
class StampEpochs {
public:
    static constexpr double kJitterMax = kStampJitterMax * 1e9; ///< nanoseconds
    /// Nanoseconds; the longest pause after which stamps continue those before it. Few robots pause for longer, and
    /// few clocks are set by less.
    static constexpr double kGapMax = 10e9;

    /// Returns the epoch of the next message of a stream, from 0.
    /// @param topic,child  the stream: a topic, and in it a frame whose transforms it has
    [[nodiscard]] std::uint32_t of(std::size_t topic, const std::string& child, RosTime stamp);

private:
    /// Stamps that continue each other.
    struct Track {
        std::uint32_t epoch = 0;
        RosTime newest = 0;
        std::uint64_t messages = 0;
    };
    using Stream = std::vector<Track>; // the one of the last stamp last

    void go_on(Stream& stream, RosTime stamp);

    std::map<std::pair<std::size_t, std::string>, Stream> streams_;
    std::uint32_t newest_ = 0; // epoch
};

} // namespace scanloom::robot
