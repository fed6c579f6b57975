#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::mapping {

/// Where a robot was when it took a scan.
struct TrajectoryPoint {
    Revision revision = 0; ///< of the scan's log entry
    double stamp = 0.0;    ///< seconds, the scan's
    Pose2 pose;            ///< T_map_robot

    friend bool operator==(const TrajectoryPoint&, const TrajectoryPoint&) = default;
};

inline constexpr std::size_t kTrajectoryBlock = 512; ///< points

/// Points that a trajectory keeps at least, if it was given so many: minutes of a robot that scans at 10 Hz. The log
/// has all of them, so that what is kept does not grow for as long as a robot lives.
inline constexpr std::size_t kTrajectoryKept = 16 * kTrajectoryBlock;

namespace detail {
using TrajectoryBlock = std::array<TrajectoryPoint, kTrajectoryBlock>;
using TrajectoryBlocks = std::vector<std::shared_ptr<TrajectoryBlock>>;
} // namespace detail

/// The points a trajectory had at one moment, by rising revision. Immutable, cheap to copy.
/// Point n is that of a robot's scan n, from 0; those before begin() are only in the log.
/// Thread  any number of readers, while the writer appends behind what they see.
class TrajectoryView {
public:
    TrajectoryView() = default;
    TrajectoryView(std::shared_ptr<const detail::TrajectoryBlocks> blocks, std::size_t begin, std::size_t size)
        : blocks_(std::move(blocks)), begin_(begin), size_(size) {}

    /// Index of the first point that is kept; size() when none is.
    [[nodiscard]] std::size_t begin() const noexcept { return begin_; }

    /// How many points there have been.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Pre: begin() <= index < size().
    [[nodiscard]] const TrajectoryPoint& operator[](std::size_t index) const noexcept {
        return (*(*blocks_)[(index - begin_) / kTrajectoryBlock])[(index - begin_) % kTrajectoryBlock];
    }

    /// Index of the first point that is kept and newer than `since`; size() when there is none.
    [[nodiscard]] std::size_t first_after(Revision since) const noexcept {
        std::size_t low = begin_;
        std::size_t high = size_;
        while (low < high) {
            const std::size_t middle = low + (high - low) / 2;
            if ((*this)[middle].revision > since) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        return low;
    }

private:
    std::shared_ptr<const detail::TrajectoryBlocks> blocks_;
    std::size_t begin_ = 0;
    std::size_t size_ = 0;
};

/// The newest of a growing list of poses, with cheap snapshots: points never move once written, views hold those they
/// were taken with. Branches share their blocks, too; the last one is copied by whoever goes on from it without having
/// begun it.
/// Thread  one writer.
class Trajectory {
public:
    Trajectory() = default;

    /// One that goes on behind so many points, of which it keeps none.
    explicit Trajectory(std::size_t before) : begin_(before), size_(before) {}

    Trajectory(Trajectory&&) noexcept = default;
    Trajectory& operator=(Trajectory&&) noexcept = default;
    ~Trajectory() = default;

    void append(const TrajectoryPoint& point) {
        if (!owns_last_) own_last();
        if (in_last() == 0) begin_block();
        (*blocks_->back())[in_last()] = point;
        ++size_;
    }

    [[nodiscard]] std::size_t block_count() const noexcept { return blocks_->size(); }

    [[nodiscard]] TrajectoryView snapshot() const { return {blocks_, begin_, size_}; }

    /// A second one that goes on from here. Each has a writer of its own.
    [[nodiscard]] Trajectory branch() const {
        Trajectory other(*this);
        other.owns_last_ = false;
        return other;
    }

private:
    Trajectory(const Trajectory&) = default; // for branch() alone

    /// Points in the last block; 0 as well where that is full.
    [[nodiscard]] std::size_t in_last() const noexcept { return (size_ - begin_) % kTrajectoryBlock; }

    /// Leaves the first one where there are enough without it.
    void begin_block() {
        const bool enough = size_ - begin_ > kTrajectoryKept;
        auto blocks = std::make_shared<detail::TrajectoryBlocks>(blocks_->begin() + (enough ? 1 : 0), blocks_->end());
        blocks->push_back(std::make_shared<detail::TrajectoryBlock>());
        blocks_ = std::move(blocks);
        if (enough) begin_ += kTrajectoryBlock;
    }

    /// Reads no further than size_: behind it another may write.
    void own_last() {
        owns_last_ = true;
        const std::size_t count = in_last();
        if (count == 0) return;
        auto blocks = std::make_shared<detail::TrajectoryBlocks>(*blocks_);
        auto last = std::make_shared<detail::TrajectoryBlock>();
        std::copy_n(blocks->back()->begin(), count, last->begin());
        blocks->back() = std::move(last);
        blocks_ = std::move(blocks);
    }

    std::shared_ptr<detail::TrajectoryBlocks> blocks_ = std::make_shared<detail::TrajectoryBlocks>();
    std::size_t begin_ = 0; // the first block's first point
    std::size_t size_ = 0;
    bool owns_last_ = true; // of the blocks
};

} // namespace scanloom::mapping
