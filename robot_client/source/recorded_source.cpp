#include "robot_client/source/recorded_source.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

std::optional<Observation> RecordedSource::next() {
    if (next_ == observations_.size()) return std::nullopt;
    return std::move(observations_[next_++]);
}

Result<> RecordedSource::resume_after(std::uint64_t seq) {
    if (seq > observations_.size()) {
        return Error{Errc::kConflict,
                     fmt::format("the server has {} scans of this robot, the recording only {}: it was "
                                 "another recording; choose another --robot or --session",
                                 seq, observations_.size())};
    }
    next_ = static_cast<std::size_t>(seq);
    return {};
}

} // namespace scanloom::robot
