#include "common/link/scan_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace scanloom::link {

void ScanQueue::start_after(std::uint64_t seq) {
    assert(sent_ever_ == 0 && acknowledged_ == 0);
    acknowledged_ = sent_ = sent_ever_ = seq;
    renumber(seq + 1);
}

void ScanQueue::mark_sent(std::size_t count) noexcept {
    assert(count <= unsent_count());
    sent_ += count;
    sent_ever_ = std::max(sent_ever_, sent_);
}

void ScanQueue::acknowledge(std::uint64_t seq) {
    assert(seq <= sent_);
    if (seq <= acknowledged_) return;
    drop_until(seq);
    acknowledged_ = seq;
}

Result<> ScanQueue::rewind(std::uint64_t seq) {
    if (seq < acknowledged_) {
        return Error{
            Errc::kConflict,
            fmt::format(
                "the server holds {} scans of this robot but had acknowledged {}; scans {} to {} are "
                "no longer in memory: restore the server's store, or restart the robot client and follow its message",
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

} // namespace scanloom::link
