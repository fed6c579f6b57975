#include "core/slam/stretch_test.hpp"

#include "core/scan_matching/line_matching.hpp"
#include "core/scan_matching/square_set.hpp"
#include "core/slam/evidence.hpp"
#include "core/slam/keyframe_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::distance_of;
using scan_matching::SurfacePoint;
using scan_matching::yaw_of;

constexpr double kStretchMax = 60.0;    // metres
constexpr double kOldMapReach = 12.0;   // metres around the stretch, in addition to the window, of the old map
constexpr double kShiftDistance = 25.0; // metres of the stretch that shifts are compared by
constexpr double kShiftStep = 0.2;      // metres between shifts
constexpr std::size_t kShifts = 8;      // best shifts that are followed
constexpr int kShiftsApart = 3;         // steps between them, at least
constexpr double kFitDistance = 1.5;    // metres travelled between keyframes that are matched
constexpr std::size_t kFitPoints = 100; // of a scan with more, every second, third... is matched
constexpr double kFitInliers = 0.5;
constexpr double kSamePlaceDistance = 0.5; // metres: closer ways at the newest keyframe are one
constexpr double kSamePlaceTurn = 0.1;     // radians
constexpr double kOverlapMin = 4.0;        // metres of the stretch that fit the old map
// A small correction that fits well needs no proof that unseen places are wrong.
constexpr double kSmallMove = 0.5;        // metres
constexpr double kSmallOverlap = 15.0;    // metres travelled with fits, at least
constexpr double kSmallShareMax = 0.1;    // of contradictions
constexpr double kLeadMin = 4.0;          // metres of evidence
constexpr double kLeadPart = 0.1;         // of the best one's matched metres
constexpr double kRefutedShare = 0.1;     // by how much a refuted hypothesis's share of contradictions is larger
constexpr double kRefutedExcess = 4.0;    // metres
constexpr double kLoopDisagreement = 0.5; // metres between a fit and an older loop edge

/// A keyframe's pose in the old map, as matched.
struct Fit {
    std::size_t keyframe = 0;
    Transform2 T_map_keyframe;
};

/// A keyframe that is matched to the old map, with some of its points.
struct FittedScan {
    std::size_t keyframe = 0;
    std::vector<SurfacePoint> points{};
};

/// A correction of the stretch, and how well the stretch then fits the old map.
struct StretchHypothesis {
    Transform2 correction; // T_corrected_map at the newest keyframe
    std::vector<Fit> fits{};
    Evidence evidence{};  // of the old map
    double overlap = 0.0; // metres travelled with fits

    [[nodiscard]] double score() const { return evidence.matched - 2.0 * evidence.contradicted; }
    [[nodiscard]] double share() const { return evidence.share(); }
};

/// The test of one stretch: the newest keyframes of a fragment against all others of the map, or, while it is not
/// located, of the fragment.
class StretchTest {
public:
    StretchTest(const KeyframeGraph& graph, const StretchQuestion& question)
        : graph_(graph), question_(question), newest_(question.keyframe),
          keyframes_(graph.fragment_of(newest_).keyframes), first_(keyframes_.size() - 1) {
        double length = kStretchMax;
        if (graph[question.anchor].fragment == graph[newest_].fragment) {
            length = std::min(length, 0.5 * before_newest(question.anchor));
        }
        while (first_ > 0 && before_newest(keyframes_[first_]) < length) --first_;
        choose_fits();
        collect_old_map();
        collect_evidence();
    }

    /// Returns the accepted hypothesis, or nullopt.
    [[nodiscard]] std::optional<StretchHypothesis> run() {
        if (old_map_.space().is_empty()) return std::nullopt;
        std::vector<StretchHypothesis> hypotheses;
        add(hypotheses, follow({.correction = question_.correction}));
        add(hypotheses, follow({.correction = Transform2()}));
        for (const Transform2& correction : shifted_corrections()) add(hypotheses, follow({.correction = correction}));
        std::ranges::stable_sort(hypotheses, std::greater(), &StretchHypothesis::score);
        const StretchHypothesis& best = hypotheses.front();
        if (best.share() > contradicted_max() || best.overlap < kOverlapMin) return std::nullopt;
        const bool is_small =
            moved_by(best) <= kSmallMove && best.overlap >= kSmallOverlap && best.share() <= kSmallShareMax;
        for (std::size_t n = 1; n < hypotheses.size(); ++n) {
            const StretchHypothesis& other = hypotheses[n];
            if (best.score() - other.score() < std::max(kLeadMin, kLeadPart * best.evidence.matched))
                return std::nullopt;
            if (is_small && other.overlap < kOverlapMin) continue; // it would move far, to where nothing fits
            if (other.share() <= best.share() + kRefutedShare) return std::nullopt;
            if (other.evidence.contradicted - best.evidence.contradicted < kRefutedExcess) return std::nullopt;
        }
        return best;
    }

    /// Returns whether a keyframe is in the stretch.
    [[nodiscard]] bool contains(std::size_t keyframe) const {
        return graph_[keyframe].fragment == graph_[newest_].fragment && graph_[keyframe].position >= first_;
    }

    /// Returns whether a keyframe is in the map that the stretch is compared with, if it is near.
    [[nodiscard]] bool is_old(std::size_t keyframe) const {
        const bool is_known =
            graph_.fragment_of(newest_).is_located ? graph_.is_in_map(keyframe) : graph_.share_frame(keyframe, newest_);
        return is_known && !contains(keyframe);
    }

private:
    /// Returns the metres travelled from a keyframe of the fragment to its newest one.
    [[nodiscard]] double before_newest(std::size_t keyframe) const {
        return graph_[newest_].travelled - graph_[keyframe].travelled;
    }

    [[nodiscard]] double contradicted_max() const {
        const double factor = question_.noise_factor;
        return question_.contradicted_max + (factor > 0.0 ? factor * contradictions_between(graph_, old_) : 0.0);
    }

    /// Returns by how much a hypothesis moves the newest keyframe, metres.
    [[nodiscard]] double moved_by(const StretchHypothesis& hypothesis) const {
        const Transform2& pose = graph_.pose(newest_);
        return distance_of(inverse(pose) * (hypothesis.correction * pose));
    }

    /// Chooses the keyframes that are matched to the old map, the newest first.
    void choose_fits() {
        for (std::size_t n = keyframes_.size(); n-- > first_;) {
            if (!fitted_.empty() &&
                before_newest(keyframes_[n]) - before_newest(fitted_.back().keyframe) < kFitDistance)
                continue;
            auto& fitted = fitted_.emplace_back(FittedScan{.keyframe = keyframes_[n]});
            const auto& points = points_of(n);
            const std::size_t step = (points.size() + kFitPoints - 1) / kFitPoints;
            for (std::size_t k = 0; k < points.size(); k += step) fitted.points.push_back(points[k]);
        }
    }

    void collect_old_map() {
        const Transform2& newest = graph_.pose(newest_);
        double left = newest.x;
        double right = left;
        double low = newest.y;
        double high = low;
        for (std::size_t n = first_; n < keyframes_.size(); ++n) {
            const Transform2& pose = graph_.pose(keyframes_[n]);
            left = std::min(left, pose.x);
            right = std::max(right, pose.x);
            low = std::min(low, pose.y);
            high = std::max(high, pose.y);
        }
        const double margin = question_.window + kOldMapReach;
        for (std::size_t n = 0; n < graph_.size(); ++n) {
            const Transform2& pose = graph_.pose(n);
            const bool is_near = pose.x >= left - margin && pose.x <= right + margin && pose.y >= low - margin &&
                                 pose.y <= high + margin;
            if (is_near && is_old(n)) old_.push_back(n);
        }
        KeyframeViews views({newest.x, newest.y}); // the newest first
        for (std::size_t n = old_.size(); n-- > 0;) views.add(graph_[old_[n]], graph_.pose(old_[n]));
        old_map_ = KeyframeMap(std::move(views));
    }

    /// Chooses the points that speak for or against a hypothesis: one in each square, of the newest keyframe that shows
    /// it.
    void collect_evidence() {
        std::size_t count = 0;
        for (std::size_t n = first_; n < keyframes_.size(); ++n) count += points_of(n).size();
        scan_matching::SquareSet taken(Evidence::kSquare, count);
        evidence_.resize(keyframes_.size() - first_);
        for (std::size_t n = keyframes_.size(); n-- > first_;) {
            for (const SurfacePoint& point : points_of(n)) {
                const Point2 at = graph_.pose(keyframes_[n]) * Point2{point.x, point.y};
                if (taken.insert(at.x, at.y)) evidence_[n - first_].push_back(point);
            }
        }
    }

    /// Returns the points of a keyframe. @param position  in the fragment
    [[nodiscard]] const std::vector<SurfacePoint>& points_of(std::size_t position) const {
        return graph_[keyframes_[position]].scan->points;
    }

    /// Returns the supposed correction, shifted to where the newest part of the stretch fits the old map best.
    [[nodiscard]] std::vector<Transform2> shifted_corrections() {
        std::vector<Point2> points;
        for (std::size_t n = keyframes_.size(); n-- > first_ && before_newest(keyframes_[n]) < kShiftDistance;) {
            const Transform2 pose = question_.correction * graph_.pose(keyframes_[n]);
            for (const SurfacePoint& point : evidence_[n - first_]) points.push_back(pose * Point2{point.x, point.y});
        }
        struct Shift {
            int score;
            int i;
            int j;
        };
        std::vector<Shift> shifts;
        const auto range = static_cast<int>(question_.window / kShiftStep);
        for (int j = -range; j <= range; ++j) {
            for (int i = -range; i <= range; ++i) {
                int score = 0;
                for (const Point2& point : points) {
                    const double x = point.x + i * kShiftStep;
                    const double y = point.y + j * kShiftStep;
                    score += old_map_.space().is_near_point(x, y) ? 1 : old_map_.space().is_free(x, y) ? -2 : 0;
                }
                shifts.push_back({score, i, j});
            }
        }
        std::ranges::stable_sort(shifts, std::greater(), &Shift::score);
        std::vector<Shift> kept;
        std::vector<Transform2> corrections;
        for (const Shift& shift : shifts) {
            if (kept.size() == kShifts) break;
            const bool is_near = std::ranges::any_of(kept, [&](const Shift& other) {
                return std::abs(other.i - shift.i) <= kShiftsApart && std::abs(other.j - shift.j) <= kShiftsApart;
            });
            if (is_near) continue;
            kept.push_back(shift);
            Transform2& correction = corrections.emplace_back(question_.correction);
            correction.x += shift.i * kShiftStep;
            correction.y += shift.j * kShiftStep;
        }
        return corrections;
    }

    /// Follows a hypothesis backwards along the stretch: by the trajectory, corrected by the chosen keyframes that fit.
    [[nodiscard]] StretchHypothesis follow(StretchHypothesis hypothesis) {
        Transform2 pose = hypothesis.correction * graph_.pose(newest_);
        auto fitted = fitted_.begin();
        for (std::size_t n = keyframes_.size(); n-- > first_;) {
            const std::size_t keyframe = keyframes_[n];
            if (n + 1 < keyframes_.size())
                pose = pose * (inverse(graph_.pose(keyframes_[n + 1])) * graph_.pose(keyframe));
            if (fitted != fitted_.end() && fitted->keyframe == keyframe) {
                const auto match =
                    match_to_lines(fitted->points, old_map_.points(), pose, {pose, 0.1, 0.05},
                                   {.steps_max = 8, .first_gate = 0.4, .first_scale = 0.2, .last_scale = 0.08});
                ++fitted;
                if (match.inlier_ratio >= kFitInliers) {
                    pose = match.T_map_robot;
                    if (hypothesis.fits.empty()) hypothesis.correction = pose * inverse(graph_.pose(keyframe));
                    hypothesis.fits.push_back({keyframe, pose});
                    const std::size_t before = fitted != fitted_.end() ? fitted->keyframe : keyframes_[first_];
                    hypothesis.overlap += graph_[keyframe].travelled - graph_[before].travelled;
                }
            }
            for (const SurfacePoint& point : evidence_[n - first_]) {
                hypothesis.evidence.add(old_map_, pose, graph_[keyframe].scan->laser, point);
            }
        }
        return hypothesis;
    }

    /// Adds a hypothesis, unless one that ends at the same place is at least as good. Removes those that are worse.
    void add(std::vector<StretchHypothesis>& kept, StretchHypothesis added) const {
        const Transform2& pose = graph_.pose(newest_);
        const auto is_same = [&](const StretchHypothesis& other) {
            const Transform2 off = inverse(other.correction * pose) * added.correction * pose;
            return distance_of(off) < kSamePlaceDistance && std::fabs(yaw_of(off)) < kSamePlaceTurn;
        };
        const auto is_better = [&](const StretchHypothesis& other) {
            return is_same(other) && other.score() >= added.score();
        };
        if (std::ranges::any_of(kept, is_better)) return;
        std::erase_if(kept, is_same);
        kept.push_back(std::move(added));
    }

    const KeyframeGraph& graph_;
    const StretchQuestion& question_;
    std::size_t newest_;
    std::span<const std::size_t> keyframes_;          // of its fragment
    std::size_t first_;                               // position of the first one of the stretch
    std::vector<FittedScan> fitted_;                  // the newest first
    std::vector<std::size_t> old_;                    // the others that are near, in the order of their scans
    KeyframeMap old_map_;                             // of these, in the map's frame
    std::vector<std::vector<SurfacePoint>> evidence_; // by position from first_
};

} // namespace

bool accept_stretch(KeyframeGraph& graph, const StretchQuestion& question) {
    StretchTest test(graph, question);
    const auto accepted = test.run();
    if (!accepted) return false;
    graph.remove_loops([&](const Edge& edge) {
        if (!test.contains(edge.to) || test.contains(edge.from)) return false;
        return std::ranges::any_of(accepted->fits, [&](const Fit& fit) {
            if (fit.keyframe != edge.to) return false;
            const Transform2 T_from_fit = inverse(graph.pose(edge.from)) * fit.T_map_keyframe;
            return distance_of(inverse(T_from_fit) * edge.T_from_to) > kLoopDisagreement;
        });
    });
    for (const Fit& fit : accepted->fits) {
        const std::size_t from =
            graph.nearest(fit.T_map_keyframe, [&](std::size_t keyframe) { return test.is_old(keyframe); }).value();
        graph.add_loop({from, fit.keyframe, inverse(graph.pose(from)) * fit.T_map_keyframe,
                        information_of(kFitSigma, kFitTurnSigma), true});
    }
    return true;
}

} // namespace scanloom::slam
