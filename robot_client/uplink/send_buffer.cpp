#include "robot_client/uplink/send_buffer.hpp"

#include "common/wire/messages.hpp"

#include <cassert>
#include <utility>

namespace scanloom::robot {

std::size_t wire_bytes_max(const Scan& scan) noexcept {
    constexpr std::size_t kFixedFields = 160; // seq, times, sensor, two poses, uniform angles, tags and lengths
    const std::size_t angle_count =
        scan.angles && !std::holds_alternative<UniformAngles>(*scan.angles) ? beam_count(*scan.angles) : 0;
    return kFixedFields + 4 * scan.ranges.size() + 5 * scan.intensities.size() + 8 * angle_count;
}

void SendBuffer::push(Observation observation) {
    assert(has_room());
    observation.scan.seq = ++last_;
    bytes_ += wire_bytes_max(observation.scan);
    scans_.push_back(std::move(observation));
}

bool SendBuffer::drop_oldest_unsent() noexcept {
    if (sent_ever() == last_) return false;
    const auto oldest = scans_.begin() + static_cast<std::ptrdiff_t>(sent_ever() - acknowledged());
    bytes_ -= wire_bytes_max(oldest->scan);
    for (auto next = scans_.erase(oldest); next != scans_.end(); ++next) --next->scan.seq;
    --last_;
    return true;
}

void SendBuffer::append_batch(std::uint64_t first, std::size_t count, std::string& out) const {
    wire::ScanBatch batch;
    batch.scans.reserve(count);
    for (std::size_t i = 0; i < count; ++i) batch.scans.push_back(at(first + i).scan);
    wire::encode(batch, out);
}

void SendBuffer::renumber(std::uint64_t first) {
    last_ = first - 1;
    for (Observation& queued : scans_) queued.scan.seq = ++last_;
}

void SendBuffer::drop_until(std::uint64_t seq) {
    for (std::uint64_t dropped = acknowledged(); dropped < seq; ++dropped) {
        bytes_ -= wire_bytes_max(scans_.front().scan);
        scans_.pop_front();
    }
}

const Observation& SendBuffer::at(std::uint64_t seq) const {
    assert(seq > acknowledged() && seq <= last_);
    return scans_[static_cast<std::size_t>(seq - acknowledged() - 1)];
}

} // namespace scanloom::robot
