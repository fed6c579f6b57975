#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace scanloom::link {

/// Counts the bytes of ScanBatch frames (including length prefix) that are outstanding on one link: sent and not yet
/// durable. A batch counts in full until its last scan is durable.
class CreditWindow {
public:
    /// Starts a new link with nothing outstanding.
    /// @param credit_bytes  Welcome::credit_bytes
    void reset(std::uint64_t credit_bytes) {
        batches_.clear();
        under_way_ = 0;
        credit_ = credit_bytes;
    }

    /// Changes the credit. Outstanding bytes still count.
    void set_credit(std::uint64_t credit_bytes) noexcept { credit_ = credit_bytes; }

    /// Returns how many bytes may be sent now; 0 also if the server has lowered the credit below the outstanding bytes.
    [[nodiscard]] std::uint64_t available() const noexcept { return credit_ > under_way_ ? credit_ - under_way_ : 0; }
    /// Returns the outstanding bytes.
    [[nodiscard]] std::uint64_t under_way() const noexcept { return under_way_; }
    /// Returns the credit, in bytes.
    [[nodiscard]] std::uint64_t credit() const noexcept { return credit_; }

    /// Counts a batch as outstanding.
    /// @param last_seq     of its last scan; greater than that of earlier batches
    /// @param frame_bytes  size of the frame, including its length prefix
    void sent(std::uint64_t last_seq, std::size_t frame_bytes) {
        batches_.push_back({last_seq, frame_bytes});
        under_way_ += frame_bytes;
    }

    /// Stops counting the batches whose scans are all durable.
    /// @param seq  highest durable Scan::seq
    void durable(std::uint64_t seq) {
        while (!batches_.empty() && batches_.front().last_seq <= seq) {
            under_way_ -= batches_.front().bytes;
            batches_.pop_front();
        }
    }

private:
    struct Batch {
        std::uint64_t last_seq = 0;
        std::size_t bytes = 0;
    };

    std::deque<Batch> batches_;
    std::uint64_t under_way_ = 0;
    std::uint64_t credit_ = 0;
};

} // namespace scanloom::link
