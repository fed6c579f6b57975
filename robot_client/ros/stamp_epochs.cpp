#include "robot_client/ros/stamp_epochs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scanloom::robot {

std::uint32_t StampEpochs::of(std::size_t topic, const std::string& child, RosTime stamp) {
    Stream& stream = streams_[{topic, child}];
    if (stream.empty()) {
        stream.push_back({newest_, stamp, 0});
    } else {
        go_on(stream, stamp);
    }
    Track& track = stream.back();
    track.newest = std::max(track.newest, stamp);
    ++track.messages;
    return track.epoch;
}

/// Makes the track that a stamp continues the last one, or begins one.
void StampEpochs::go_on(Stream& stream, RosTime stamp) {
    constexpr std::size_t kTracksMax = 8;
    const auto step_from = [&](const Track& track) {
        return static_cast<double>(stamp) - static_cast<double>(track.newest); // no overflow
    };
    const Track last = stream.back();
    const double step = step_from(last);
    if (std::fabs(step) <= kJitterMax) return;
    // A single stamp may be wrong; after several ones, a step forward is a pause.
    const bool is_pause = step > 0.0 && step <= kGapMax && last.messages > 1;
    const auto nearest =
        std::ranges::min_element(stream, {}, [&](const Track& track) { return std::fabs(step_from(track)); });
    const bool continues = step_from(*nearest) >= -kJitterMax && step_from(*nearest) <= kGapMax;
    if (!is_pause && continues) {
        std::rotate(nearest, std::next(nearest), stream.end());
        return;
    }
    const bool falls = step < 0.0;
    if (falls && last.epoch == newest_) ++newest_;
    stream.push_back({falls ? newest_ : last.epoch, stamp, 0});
    if (stream.size() > kTracksMax) stream.erase(stream.begin());
}

} // namespace scanloom::robot
