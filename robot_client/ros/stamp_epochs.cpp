#include "robot_client/ros/stamp_epochs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scanloom::robot {

std::uint32_t StampEpochs::of(std::size_t topic, const std::string& child, RosTime stamp) {
    constexpr std::size_t kTracksMax = 8;
    Stream& stream = streams_[{topic, child}];
    const auto step_from = [&](const Track& track) {
        return std::fabs(static_cast<double>(stamp) - static_cast<double>(track.newest)); // no overflow
    };
    if (stream.empty()) {
        stream.push_back({newest_, stamp});
    } else if (const Track last = stream.back(); step_from(last) > kJitterMax) {
        const auto nearest = std::ranges::min_element(stream, {}, step_from);
        const bool continues = step_from(*nearest) <= (stamp < nearest->newest ? kJitterMax : kGapMax);
        if (continues) {
            std::rotate(nearest, std::next(nearest), stream.end()); // it becomes the last one
        } else {
            const bool falls = stamp < last.newest;
            if (falls && last.epoch == newest_) ++newest_;
            stream.push_back({falls ? newest_ : last.epoch, stamp});
            if (stream.size() > kTracksMax) stream.erase(stream.begin());
        }
    }
    Track& track = stream.back();
    track.newest = std::max(track.newest, stamp);
    return track.epoch;
}

} // namespace scanloom::robot
