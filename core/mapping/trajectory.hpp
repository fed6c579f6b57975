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

/// A robot's pose at one of its scans.
struct TrajectoryPoint {
    Revision revision = 0; ///< of the scan's log entry
    double stamp = 0.0;    ///< seconds, of the scan
    Pose2 pose;            ///< T_map_robot

    friend bool operator==(const TrajectoryPoint&, const TrajectoryPoint&) = default;
};

inline constexpr std::size_t kTrajectoryBlock = 512; ///< points

/// The number of newest points that a trajectory keeps at least: minutes of a robot that scans at 10 Hz. Limits the
/// memory of a robot that runs for long; the log contains all points.
inline constexpr std::size_t kTrajectoryKept = 16 * kTrajectoryBlock;

namespace detail {
using TrajectoryBlock = std::array<TrajectoryPoint, kTrajectoryBlock>;
using TrajectoryBlocks = std::vector<std::shared_ptr<TrajectoryBlock>>;
} // namespace detail

/// The points of a trajectory at one moment, by increasing revision. Immutable, cheap to copy.
///
/// Point n belongs to the robot's scan n, counted from 0. Points before begin() are only in the log.
/// Threads: any number of readers, while the writer appends points after those in the view.
class TrajectoryView {
public:
    TrajectoryView() = default;
    /// Creates a view of the blocks of a trajectory. Obtain views from Trajectory::snapshot() instead.
    TrajectoryView(std::shared_ptr<const detail::TrajectoryBlocks> blocks, std::size_t begin, std::size_t size)
        : blocks_(std::move(blocks)), begin_(begin), size_(size) {}

    /// Returns the index of the first point that is kept; size() if none is.
    [[nodiscard]] std::size_t begin() const noexcept { return begin_; }

    /// Returns the number of points, including those no longer kept.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Returns the point with this index.
    /// @param index  number of the robot's integrated scan, from 0
    /// Precondition: begin() <= index < size().
    [[nodiscard]] const TrajectoryPoint& operator[](std::size_t index) const noexcept {
        return (*(*blocks_)[(index - begin_) / kTrajectoryBlock])[(index - begin_) % kTrajectoryBlock];
    }

    /// Returns the index of the first point that is kept and newer than `since`; size() if there is none.
    /// @param since  revision of a log entry
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

/// The newest points of a growing list of poses, with cheap snapshots.
///
/// Points never move once written, and views hold the blocks that they were taken with. Branches share their blocks. A
/// branch copies the last block before it appends to it.
/// Threads: one writer.
class Trajectory {
public:
    Trajectory() = default;

    /// Starts a trajectory after `before` points that it does not keep.
    /// @param before  number of earlier points
    explicit Trajectory(std::size_t before) : begin_(before), size_(before) {}

    Trajectory(Trajectory&&) noexcept = default;
    Trajectory& operator=(Trajectory&&) noexcept = default;
    ~Trajectory() = default;

    /// Adds a point. Pre: its revision is greater than that of the newest point.
    void append(const TrajectoryPoint& point) {
        if (!owns_last_) own_last();
        if (in_last() == 0) begin_block();
        (*blocks_->back())[in_last()] = point;
        ++size_;
    }

    /// Returns the number of blocks that are kept.
    [[nodiscard]] std::size_t block_count() const noexcept { return blocks_->size(); }

    /// Returns the current points. Points appended later are not in the view.
    [[nodiscard]] TrajectoryView snapshot() const { return {blocks_, begin_, size_}; }

    /// Returns a second trajectory with the same points and its own writer.
    [[nodiscard]] Trajectory branch() const {
        Trajectory other(*this);
        other.owns_last_ = false;
        return other;
    }

private:
    Trajectory(const Trajectory&) = default; // for branch() alone

    /// Returns the number of points in the last block; 0 also if that block is full.
    [[nodiscard]] std::size_t in_last() const noexcept { return (size_ - begin_) % kTrajectoryBlock; }

    /// Starts a new block. Drops the first block if enough points remain without it.
    void begin_block() {
        const bool enough = size_ - begin_ > kTrajectoryKept;
        auto blocks = std::make_shared<detail::TrajectoryBlocks>(blocks_->begin() + (enough ? 1 : 0), blocks_->end());
        blocks->push_back(std::make_shared<detail::TrajectoryBlock>());
        blocks_ = std::move(blocks);
        if (enough) begin_ += kTrajectoryBlock;
    }

    /// Copies the last block up to size_; another trajectory may be writing after it.
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
    std::size_t begin_ = 0; // index of the first block's first point
    std::size_t size_ = 0;
    bool owns_last_ = true; // whether this trajectory alone writes to the last block
};

} // namespace scanloom::mapping
