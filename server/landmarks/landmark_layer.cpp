#include "server/landmarks/landmark_layer.hpp"

#include "server/landmarks/metrics.hpp"

#include <cassert>
#include <utility>

namespace scanloom::landmarks {
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
