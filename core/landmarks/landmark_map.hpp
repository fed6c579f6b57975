#pragma once

#include "common/scan/log_entry.hpp"
#include "core/landmarks/captures.hpp"
#include "core/landmarks/landmark.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::landmarks {

/// A landmark's position is the per-axis median of its last observations, at most this many.
inline constexpr std::size_t kSightingsKept = 15;

/// A landmark of a session, seen from one place or several. Metres, map frame.
struct MapLandmark {
    std::uint32_t id = 0;                                          ///< number in the session, from 0; never changes
    std::uint32_t seen = 0;                                        ///< number of keyframes that show it
    Revision first = 0;                                            ///< log entry at which the first of them ended
    Revision last = 0;                                             ///< log entry at which the newest of them ended
    Landmark landmark;                                             ///< as it was seen last, except for its position
    std::array<std::array<double, 2>, kSightingsKept> sightings{}; ///< a ring: sighting n is at n % kSightingsKept

    friend bool operator==(const MapLandmark&, const MapLandmark&) = default;
};

inline constexpr std::size_t kLandmarkBlock = 32; ///< landmarks of one block, which views share

namespace detail {
struct LandmarkBlock {
    Revision revision = 0; ///< of the last change
    std::vector<MapLandmark> landmarks;
};
using LandmarkBlocks = std::vector<std::shared_ptr<const LandmarkBlock>>;
} // namespace detail

/// The landmarks of a session at one moment, by id. Immutable, cheap to copy.
/// Threads: any number of readers.
class LandmarkView {
public:
    LandmarkView() = default;
    /// Creates a view of the landmarks of a map. Obtain views from LandmarkMap::snapshot() instead.
    explicit LandmarkView(std::shared_ptr<const detail::LandmarkBlocks> blocks) : blocks_(std::move(blocks)) {}

    /// Returns the number of landmarks.
    [[nodiscard]] std::size_t size() const noexcept {
        return blocks_->empty() ? 0 : (blocks_->size() - 1) * kLandmarkBlock + blocks_->back()->landmarks.size();
    }

    /// Returns the landmark with the given id.
    /// @param id  MapLandmark::id
    /// Precondition: id < size().
    [[nodiscard]] const MapLandmark& operator[](std::size_t id) const noexcept {
        return (*blocks_)[id / kLandmarkBlock]->landmarks[id % kLandmarkBlock];
    }

    /// Returns the landmarks in blocks of kLandmarkBlock. Each block has the revision of its last change.
    [[nodiscard]] const detail::LandmarkBlocks& blocks() const noexcept { return *blocks_; }

private:
    std::shared_ptr<const detail::LandmarkBlocks> blocks_ = std::make_shared<const detail::LandmarkBlocks>();
};

/// All landmarks of a session. Recognizes known landmarks in keyframes and adds new ones.
/// Threads: one writer; any thread may use views.
class LandmarkMap {
public:
    /// Adds the landmarks of one keyframe. A landmark that is the mutual nearest neighbour of a known one, within
    /// kTolerance, counts as another observation of it. The others are new, in their order.
    /// @param seen      landmarks of the keyframe, metres, map frame
    /// @param revision  log entry at which the keyframe ended
    /// @return how many were known
    /// Cost: proportional to the landmarks of the keyframe and the known ones around them.
    std::size_t add(std::span<const Landmark> seen, Revision revision);

    /// Returns the number of landmarks.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Returns a view of the current landmarks. Cheap: only blocks that change later are copied.
    [[nodiscard]] LandmarkView snapshot();

private:
    using CellKey = std::pair<std::int32_t, std::int32_t>; // squares of kTolerance

    [[nodiscard]] const MapLandmark& at(std::uint32_t id) const;
    [[nodiscard]] detail::LandmarkBlock& writable(std::size_t block);
    [[nodiscard]] std::vector<std::uint32_t> known_around(std::span<const Landmark> seen) const;
    void add_new(const Landmark& landmark, Revision revision);
    void see_again(std::uint32_t id, const Landmark& landmark, Revision revision);
    void place(std::uint32_t id, const Point2& position);
    void take_away(std::uint32_t id, const Point2& position);

    std::vector<std::shared_ptr<detail::LandmarkBlock>> blocks_;
    std::vector<bool> is_shared_;                          // for each block: whether views use it (copy on write)
    std::map<CellKey, std::vector<std::uint32_t>> ids_in_; // ids of the landmarks in each square
    std::size_t size_ = 0;
    LandmarkView view_;
    bool has_changed_ = false; // since view_ was made
};

/// How consistent successive observations are: sums over pairs of successive keyframes of one robot. Each sum follows
/// the number to divide it by.
struct PairSums {
    std::uint64_t persistence_pairs = 0; ///< pairs whose first keyframe has landmarks
    double persistence = 0.0;            ///< sum of Metrics::persistence
    std::uint64_t stability_pairs = 0;   ///< pairs in which landmarks matched
    double stability = 0.0;              ///< sum of Metrics::stability
    std::uint64_t landmarks = 0;         ///< of all keyframes
    double continuity = 0.0;             ///< sum over these landmarks

    friend bool operator==(const PairSums&, const PairSums&) = default;
};

/// The landmarks of a session at one moment.
struct LandmarkState {
    LandmarkView landmarks;     ///< by id
    std::uint64_t captures = 0; ///< number of keyframes
    PairSums sums;              ///< over successive keyframes
};

/// The landmarks of a session's keyframes. Finds the landmarks of each keyframe (adaptive eps, DBSCAN, medians) and
/// matches them with the known ones and with those of the same robot's previous keyframe.
/// Threads: one writer; any thread may use what snapshot() returned.
class LandmarkLayer {
public:
    /// Adds the next keyframe. Its robot may have any index, also one that was not seen before.
    /// @param ended  a keyframe of SessionCaptures; they are added in the order in which they end
    void add(const RobotCapture& ended);

    /// Returns the number of landmarks.
    [[nodiscard]] std::size_t size() const noexcept { return map_.size(); }
    /// Returns the current landmarks and sums. Cheap: only blocks that change later are copied.
    [[nodiscard]] LandmarkState snapshot() { return {map_.snapshot(), captures_, sums_}; }

private:
    LandmarkMap map_;
    std::vector<std::optional<std::vector<Landmark>>> seen_last_; // by RobotIndex: in the last keyframe, if any
    std::uint64_t captures_ = 0;
    PairSums sums_;
};

} // namespace scanloom::landmarks
