#include "robot_client/uplink/send_buffer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace scanloom::robot {

std::size_t wire_bytes_max(const Scan& scan) noexcept {
    constexpr std::size_t kFixedFields = 160; // seq, stamp, sensor, two poses, uniform angles, tags and lengths
    const std::size_t angle_count =
        scan.angles && !std::holds_alternative<UniformAngles>(*scan.angles) ? beam_count(*scan.angles) : 0;
    return kFixedFields + 4 * scan.ranges.size() + 5 * scan.intensities.size() + 8 * angle_count;
}

void SendBuffer::start_after(std::uint64_t seq) noexcept {
    assert(sent_ever_ == 0 && acknowledged_ == 0);
    acknowledged_ = sent_ = sent_ever_ = last_ = seq;
    for (Observation& pushed : scans_) pushed.scan.seq = ++last_;
}

void SendBuffer::push(Observation observation) {
    assert(has_room());
    observation.scan.seq = ++last_;
    bytes_ += wire_bytes_max(observation.scan);
    scans_.push_back(std::move(observation));
}

bool SendBuffer::drop_oldest_unsent() noexcept {
    if (sent_ever_ == last_) return false;
    const auto oldest = scans_.begin() + static_cast<std::ptrdiff_t>(sent_ever_ - acknowledged_);
    bytes_ -= wire_bytes_max(oldest->scan);
    for (auto next = scans_.erase(oldest); next != scans_.end(); ++next) --next->scan.seq;
    --last_;
    return true;
}

const Observation& SendBuffer::unsent(std::size_t index) const noexcept {
    assert(index < unsent_count());
    return scans_[static_cast<std::size_t>(sent_ - acknowledged_) + index];
}

void SendBuffer::mark_sent(std::size_t count) noexcept {
    assert(count <= unsent_count());
    sent_ += count;
    sent_ever_ = std::max(sent_ever_, sent_);
}

void SendBuffer::acknowledge(std::uint64_t seq) noexcept {
    assert(seq <= sent_);
    for (; acknowledged_ < seq; ++acknowledged_) {
        bytes_ -= wire_bytes_max(scans_.front().scan);
        scans_.pop_front();
    }
}

Result<> SendBuffer::rewind(std::uint64_t seq) {
    if (seq < acknowledged_) {
        return Error{
            Errc::kConflict,
            fmt::format("the server holds {} scans of this robot but had acknowledged {}; scans {} to {} are "
                        "no longer in memory: restore the server's store, or start again and go by what is said then",
                        seq, acknowledged_, seq + 1, acknowledged_)};
    }
    if (seq > sent_ever_) {
        return Error{
            Errc::kConflict,
            fmt::format("the server holds {} scans of this robot, only {} were sent from here: another program "
                        "uses the same --robot and --session",
                        seq, sent_ever_)};
    }
    sent_ = std::max(sent_, seq); // an earlier link may have delivered more than was sent again since
    acknowledge(seq);
    sent_ = seq;
    return {};
}

} // namespace scanloom::robot
