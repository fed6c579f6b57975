#include "core/slam/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace scanloom::slam {
namespace {

using scan_matching::distance_of;
using scan_matching::yaw_of;

constexpr double kScanMargin = 0.25;      // candidates of one scan with a value below the best by more are dropped
constexpr double kHypothesisMargin = 0.6; // likewise hypotheses, by their sums
constexpr double kSameHypothesisDistance = 0.08; // metres: closer hypotheses are one
constexpr double kSameHypothesisTurn = 0.04;     // radians
constexpr double kNewPart = 0.1;                 // of the newest prediction in the running mismatch
constexpr double kGoodInliers = 0.7;             // of scans that count for the running mismatch

} // namespace

void Tracker::begin(KeyframeMap map, const Transform2& T_keyframe_robot) {
    map_ = std::move(map);
    hypotheses_.resize(1);
    hypotheses_.front().last = T_keyframe_robot;
    hypotheses_.front().unmatched = 0;
}

void Tracker::follow(const ScanPoints& scan, const std::optional<Transform2>& motion) {
    const bool is_open = hypotheses_.size() > 1;
    std::vector<Hypothesis> next;
    for (const Hypothesis& hypothesis : hypotheses_) {
        const Prediction prediction{hypothesis.last, hypothesis.velocity, motion, position_mismatch_, yaw_mismatch_};
        const auto candidates = candidates_of(scan, map_, prediction, is_open ? Care::kValued : Care::kOneIfPlain);
        const double best = std::ranges::max_element(candidates, {}, &Candidate::value)->value;
        for (const Candidate& candidate : candidates) {
            if (candidate.value < best - kScanMargin) continue;
            Hypothesis& followed = next.emplace_back(hypothesis);
            followed.velocity = inverse(hypothesis.last) * candidate.scan.T_keyframe_robot;
            followed.last = candidate.scan.T_keyframe_robot;
            followed.value += candidate.value;
            followed.unmatched = candidate.scan.is_matched ? 0 : hypothesis.unmatched + 1;
            followed.scans.push_back(candidate.scan);
            if (!candidate.scan.is_matched && !motion) { // it may have stopped
                const auto& velocity = followed.velocity;
                followed.velocity = {0.5 * velocity.x, 0.5 * velocity.y,
                                     scan_matching::sin_cos(0.5 * yaw_of(velocity))};
            }
        }
    }
    const Transform2 predicted = hypotheses_.front().last * (motion ? *motion : hypotheses_.front().velocity);
    keep_best(std::move(next));
    const Hypothesis& best = hypotheses_.front();
    if (hypotheses_.size() == 1 && best.scans.size() == 1) measure_mismatch(best, predicted);
}

/// Keeps the hypotheses with the highest values, and of those at one place the best.
void Tracker::keep_best(std::vector<Hypothesis> hypotheses) {
    std::ranges::stable_sort(hypotheses, std::greater(), &Hypothesis::value);
    hypotheses_.clear();
    for (Hypothesis& hypothesis : hypotheses) {
        if (hypotheses_.size() == kHypothesesMax) return;
        if (!hypotheses_.empty() && hypothesis.value < hypotheses_.front().value - kHypothesisMargin) return;
        const bool is_known = std::ranges::any_of(hypotheses_, [&](const Hypothesis& other) {
            const Transform2 off = inverse(other.last) * hypothesis.last;
            return off.x * off.x + off.y * off.y < kSameHypothesisDistance * kSameHypothesisDistance &&
                   std::fabs(yaw_of(off)) < kSameHypothesisTurn;
        });
        if (!is_known) hypotheses_.push_back(std::move(hypothesis));
    }
}

void Tracker::measure_mismatch(const Hypothesis& hypothesis, const Transform2& predicted) {
    if (!hypothesis.scans.back().is_matched || hypothesis.scans.back().inlier_ratio < kGoodInliers) return;
    const Transform2 off = inverse(predicted) * hypothesis.last;
    position_mismatch_ += kNewPart * (distance_of(off) - position_mismatch_);
    yaw_mismatch_ += kNewPart * (std::fabs(yaw_of(off)) - yaw_mismatch_);
}

std::vector<TrackedScan> Tracker::decide() {
    hypotheses_.resize(1);
    hypotheses_.front().value = 0.0;
    return std::exchange(hypotheses_.front().scans, {});
}

} // namespace scanloom::slam
