#include "core/landmarks/landmark_map.hpp"

#include "core/landmarks/landmark.hpp"
#include "core/landmarks/landmark_matching.hpp"
#include "core/landmarks/points.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::landmarks {
namespace {

std::pair<std::int32_t, std::int32_t> cell_of(const Point2& position) {
    return {static_cast<std::int32_t>(std::floor(position.y / kTolerance)),
            static_cast<std::int32_t>(std::floor(position.x / kTolerance))};
}

/// Returns the median of the observations kept.
Point2 median_position(const MapLandmark& known) {
    const std::size_t count = std::min<std::size_t>(known.seen, kSightingsKept);
    std::array<double, kSightingsKept> values{};
    const auto along = [&](std::size_t axis) {
        for (std::size_t n = 0; n < count; ++n) values[n] = known.sightings[n][axis];
        return median(std::span(values).first(count));
    };
    const double x = along(0);
    return {x, along(1)};
}

} // namespace

std::size_t LandmarkMap::add(std::span<const Landmark> seen, Revision revision) {
    const auto around = known_around(seen);
    std::vector<Point2> known;
    for (const auto id : around) known.push_back(at(id).landmark.position);
    const auto matches = match(positions_of(seen), known, kTolerance);
    assert(matches); // landmarks are finite
    std::vector<bool> is_known(seen.size());
    for (const auto& found : *matches) {
        is_known[found.first] = true;
        see_again(around[found.second], seen[found.first], revision);
    }
    for (std::size_t n = 0; n < seen.size(); ++n) {
        if (!is_known[n]) add_new(seen[n], revision);
    }
    return matches->size();
}

/// Returns the ids of nearby landmarks in ascending order, so that of equally near ones the oldest is matched.
std::vector<std::uint32_t> LandmarkMap::known_around(std::span<const Landmark> seen) const {
    std::vector<std::uint32_t> ids;
    for (const auto& landmark : seen) {
        const auto [j, i] = cell_of(landmark.position);
        for (std::int32_t row = j - 1; row <= j + 1; ++row) {
            const auto end = ids_in_.upper_bound({row, i + 1});
            for (auto cell = ids_in_.lower_bound({row, i - 1}); cell != end; ++cell) {
                ids.insert(ids.end(), cell->second.begin(), cell->second.end());
            }
        }
    }
    std::ranges::sort(ids);
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

void LandmarkMap::add_new(const Landmark& landmark, Revision revision) {
    if (size_ % kLandmarkBlock == 0) {
        blocks_.push_back(std::make_shared<detail::LandmarkBlock>());
        is_shared_.push_back(false);
    }
    auto& block = writable(blocks_.size() - 1);
    const auto id = static_cast<std::uint32_t>(size_++);
    auto& known = block.landmarks.emplace_back(MapLandmark{id, 1, revision, revision, landmark});
    known.sightings[0] = {landmark.position.x, landmark.position.y};
    block.revision = revision;
    place(id, landmark.position);
}

void LandmarkMap::see_again(std::uint32_t id, const Landmark& landmark, Revision revision) {
    auto& block = writable(id / kLandmarkBlock);
    auto& known = block.landmarks[id % kLandmarkBlock];
    take_away(id, known.landmark.position);
    known.sightings[known.seen % kSightingsKept] = {landmark.position.x, landmark.position.y};
    known.seen += 1;
    known.last = revision;
    known.landmark = landmark;
    known.landmark.position = median_position(known);
    block.revision = revision;
    place(id, known.landmark.position);
}

void LandmarkMap::place(std::uint32_t id, const Point2& position) { ids_in_[cell_of(position)].push_back(id); }

void LandmarkMap::take_away(std::uint32_t id, const Point2& position) {
    const auto cell = ids_in_.find(cell_of(position));
    std::erase(cell->second, id);
    if (cell->second.empty()) ids_in_.erase(cell);
}

const MapLandmark& LandmarkMap::at(std::uint32_t id) const {
    return blocks_[id / kLandmarkBlock]->landmarks[id % kLandmarkBlock];
}

detail::LandmarkBlock& LandmarkMap::writable(std::size_t block) {
    has_changed_ = true;
    if (is_shared_[block]) {
        blocks_[block] = std::make_shared<detail::LandmarkBlock>(*blocks_[block]);
        is_shared_[block] = false;
    }
    return *blocks_[block];
}

LandmarkView LandmarkMap::snapshot() {
    if (!std::exchange(has_changed_, false)) return view_;
    is_shared_.assign(blocks_.size(), true);
    view_ = LandmarkView(std::make_shared<const detail::LandmarkBlocks>(blocks_.begin(), blocks_.end()));
    return view_;
}

namespace {

void add_pair(PairSums& sums, std::span<const Landmark> first, std::span<const Landmark> second) {
    const auto matches = match(positions_of(first), positions_of(second), kTolerance);
    assert(matches); // landmarks are finite
    const auto metrics = metrics_of(*matches, first.size(), kTolerance);
    if (metrics.persistence) {
        sums.persistence_pairs += 1;
        sums.persistence += *metrics.persistence;
    }
    if (metrics.stability) {
        sums.stability_pairs += 1;
        sums.stability += *metrics.stability;
    }
}

} // namespace

void LandmarkLayer::add(const RobotCapture& ended) {
    auto seen = find_landmarks(in_metres(ended.capture.points));
    if (!seen) return; // a point is beyond the limit of coordinates
    if (seen_last_.size() <= ended.robot) seen_last_.resize(ended.robot + 1);
    auto& seen_last = seen_last_[ended.robot];
    if (seen_last) add_pair(sums_, *seen_last, *seen);
    sums_.landmarks += seen->size();
    for (const auto& landmark : *seen) sums_.continuity += landmark.continuity;
    map_.add(*seen, ended.ended);
    seen_last = std::move(*seen);
    ++captures_;
}

} // namespace scanloom::landmarks
