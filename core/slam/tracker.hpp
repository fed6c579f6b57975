#pragma once

#include "core/slam/candidates.hpp"
#include "core/slam/keyframe_map.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// Follows a robot by matching each scan to the map of the newest keyframes. If several poses fit a scan, it follows up
/// to kHypothesesMax hypotheses through the next scans: until one is clearly better, a keyframe is due, or kOpenMax
/// scans were added.
/// Source: own, after multiple hypothesis tracking, Reid, An Algorithm for Tracking Multiple Targets (1979).
/// Threads: one at a time.
class Tracker {
public:
    static constexpr std::size_t kHypothesesMax = 4; ///< followed at once
    static constexpr std::size_t kOpenMax = 12;      ///< scans before the best hypothesis counts

    /// Continues from another keyframe, with a map in its frame.
    /// @param map               of the keyframes around
    /// @param T_keyframe_robot  where the robot is now
    /// Precondition: all scans are decided.
    void begin(KeyframeMap map, const Transform2& T_keyframe_robot);

    /// Adds the next scan.
    /// @param scan    its points
    /// @param motion  T_last_robot by the odometry since the last scan; nullopt: there is none
    /// @tparam IsDue  bool(const TrackedScan&)
    /// @param is_due  whether a keyframe is due at a scan that fits the map: then the best hypothesis counts
    /// @return the poses of the scans that are decided now, oldest first: none, or this one and all that were open
    template <class IsDue>
    [[nodiscard]] std::vector<TrackedScan> add(const ScanPoints& scan, const std::optional<Transform2>& motion,
                                               IsDue is_due) {
        follow(scan, motion);
        const Hypothesis& best = hypotheses_.front();
        const bool is_decided = hypotheses_.size() == 1 || best.scans.size() >= kOpenMax ||
                                (best.unmatched == 0 && is_due(best.scans.back()));
        return is_decided ? decide() : std::vector<TrackedScan>();
    }

    /// Decides for the best hypothesis. Returns the poses of the scans that were open, oldest first.
    std::vector<TrackedScan> decide();

    /// Returns the best estimate for the newest scan. Precondition: it is not decided.
    [[nodiscard]] const TrackedScan& newest() const noexcept { return hypotheses_.front().scans.back(); }

    /// Returns the motion between the last two scans by the best estimate: T_before_last.
    [[nodiscard]] const Transform2& velocity() const noexcept { return hypotheses_.front().velocity; }

    /// Returns the number of scans since the last one that matched.
    [[nodiscard]] std::size_t unmatched() const noexcept { return hypotheses_.front().unmatched; }

    /// Returns the number of scans that are not decided.
    [[nodiscard]] std::size_t open_count() const noexcept { return hypotheses_.front().scans.size(); }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.map_, self.hypotheses_, self.position_mismatch_, self.yaw_mismatch_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent() const;

private:
    /// Poses of the scans since the last decision.
    struct Hypothesis {
        Transform2 last;           // T_keyframe_robot at the last scan
        Transform2 velocity;       // between the last two scans
        double value = 0.0;        // sum over the open scans
        std::size_t unmatched = 0; // scans since the last one that matched
        std::vector<TrackedScan> scans;
    };

    void follow(const ScanPoints& scan, const std::optional<Transform2>& motion);
    void keep_best(std::vector<Hypothesis> hypotheses);
    void measure_mismatch(const Hypothesis& hypothesis, const Transform2& predicted);

    KeyframeMap map_;
    std::vector<Hypothesis> hypotheses_ = std::vector<Hypothesis>(1); // best first; at least one
    double position_mismatch_ = 0.02; // metres, mean distance of predictions from matched poses
    double yaw_mismatch_ = 0.01;      // radians, likewise
};

} // namespace scanloom::slam
