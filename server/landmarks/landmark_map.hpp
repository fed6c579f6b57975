#pragma once

#include "common/scan/log_entry.hpp"
#include "server/landmarks/landmark.hpp"
#include "server/landmarks/matching.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::landmarks {

/// A landmark's position is the per-axis median of where it was seen the last times, so many.
inline constexpr std::size_t kSightingsKept = 15;

/// A landmark of a session, seen from one place or from many. Metres, map frame.
struct MapLandmark {
    std::uint32_t id = 0;                                          ///< its number in the session, from 0, for ever
    std::uint32_t seen = 0;                                        ///< by so many captures
    Revision first = 0;                                            ///< log entry that the first of them ended with
    Revision last = 0;                                             ///< and the newest
    Landmark landmark;                                             ///< as it was seen last, but for its position
    std::array<std::array<double, 2>, kSightingsKept> sightings{}; ///< a ring: sighting n is at n % kSightingsKept

    friend bool operator==(const MapLandmark&, const MapLandmark&) = default;
};

inline constexpr std::size_t kLandmarkBlock = 32;

namespace detail {
struct LandmarkBlock {
    Revision revision = 0; ///< of the last change
    std::vector<MapLandmark> landmarks;
};
using LandmarkBlocks = std::vector<std::shared_ptr<const LandmarkBlock>>;
} // namespace detail

/// The landmarks of a session at one moment, by id. Immutable, cheap to copy.
/// Thread  any number of readers.
class LandmarkView {
public:
    LandmarkView() = default;
    explicit LandmarkView(std::shared_ptr<const detail::LandmarkBlocks> blocks) : blocks_(std::move(blocks)) {}

    [[nodiscard]] std::size_t size() const noexcept {
        return blocks_->empty() ? 0 : (blocks_->size() - 1) * kLandmarkBlock + blocks_->back()->landmarks.size();
    }

    /// Pre: id < size().
    [[nodiscard]] const MapLandmark& operator[](std::size_t id) const noexcept {
        return (*blocks_)[id / kLandmarkBlock]->landmarks[id % kLandmarkBlock];
    }

    /// In blocks of kLandmarkBlock; each knows when it changed last.
    [[nodiscard]] const detail::LandmarkBlocks& blocks() const noexcept { return *blocks_; }

private:
    std::shared_ptr<const detail::LandmarkBlocks> blocks_ = std::make_shared<const detail::LandmarkBlocks>();
};

/// All landmarks of a session: what captures see is found again, or new.
/// Thread  one writer; views are for everybody.
class LandmarkMap {
public:
    /// Adds what one capture saw: a landmark that is the mutual nearest of one that is known, within kTolerance, is
    /// that one, seen once more; others are new, in their order.
    /// @return how many were known
    /// Cost  the landmarks seen, and the known ones around them.
    std::size_t add(std::span<const Landmark> seen, Revision revision);

    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Cheap; what changes next is copied first, a block at a time.
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
    std::vector<bool> is_shared_;                          // with views: for each block, not to be written any more
    std::map<CellKey, std::vector<std::uint32_t>> ids_in_; // where landmarks are
    std::size_t size_ = 0;
    LandmarkView view_;
    bool has_changed_ = false; // since view_ was made
};

} // namespace scanloom::landmarks
