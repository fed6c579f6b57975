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

namespace detail {
using TrajectoryBlock = std::array<TrajectoryPoint, kTrajectoryBlock>;
using TrajectoryBlocks = std::vector<std::shared_ptr<TrajectoryBlock>>;
} // namespace detail

/// The points a trajectory had at one moment, by rising revision. Immutable, cheap to copy.
/// Thread  any number of readers, while the writer appends behind what they see.
class TrajectoryView {
public:
    TrajectoryView() = default;
    TrajectoryView(std::shared_ptr<const detail::TrajectoryBlocks> blocks, std::size_t size)
        : blocks_(std::move(blocks)), size_(size) {}

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] const TrajectoryPoint& operator[](std::size_t index) const noexcept {
        return (*(*blocks_)[index / kTrajectoryBlock])[index % kTrajectoryBlock];
    }

    /// Index of the first point newer than `since`; size() when there is none.
    [[nodiscard]] std::size_t first_after(Revision since) const noexcept {
        std::size_t low = 0;
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
    std::size_t size_ = 0;
};

/// A growing list of poses with cheap snapshots: points never move once written, views stop at the
/// length they were taken at. Branches share their blocks, too; the last one is copied by whoever goes on from it
/// without having begun it.
/// Thread  one writer.
class Trajectory {
public:
    Trajectory() = default;
    Trajectory(Trajectory&&) noexcept = default;
    Trajectory& operator=(Trajectory&&) noexcept = default;
    ~Trajectory() = default;

    void append(const TrajectoryPoint& point) {
        if (!owns_last_) own_last();
        if (size_ % kTrajectoryBlock == 0) {
            auto longer = std::make_shared<detail::TrajectoryBlocks>(*blocks_);
            longer->push_back(std::make_shared<detail::TrajectoryBlock>());
            blocks_ = std::move(longer);
        }
        (*blocks_->back())[size_ % kTrajectoryBlock] = point;
        ++size_;
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    [[nodiscard]] TrajectoryView snapshot() const { return {blocks_, size_}; }

    /// A second one that goes on from here. Each has a writer of its own.
    [[nodiscard]] Trajectory branch() const {
        Trajectory other(*this);
        other.owns_last_ = false;
        return other;
    }

private:
    Trajectory(const Trajectory&) = default; // for branch() alone

    /// Reads no further than size_: behind it another may write.
    void own_last() {
        owns_last_ = true;
        const std::size_t count = size_ % kTrajectoryBlock;
        if (count == 0) return;
        auto blocks = std::make_shared<detail::TrajectoryBlocks>(*blocks_);
        auto last = std::make_shared<detail::TrajectoryBlock>();
        std::copy_n(blocks->back()->begin(), count, last->begin());
        blocks->back() = std::move(last);
        blocks_ = std::move(blocks);
    }

    std::shared_ptr<detail::TrajectoryBlocks> blocks_ = std::make_shared<detail::TrajectoryBlocks>();
    std::size_t size_ = 0;
    bool owns_last_ = true; // of the blocks
};

} // namespace scanloom::mapping
