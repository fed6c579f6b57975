#pragma once

#include "core/slam/keyframe.hpp"
#include "core/slam/pose_graph.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace scanloom::slam {

/// The keyframes of a robot, their poses, and the relative poses measured between them.
/// Threads: one at a time.
class KeyframeGraph {
public:
    /// Adds a keyframe after the newest one.
    /// @param scan                 its points
    /// @param T_newest_keyframe    its pose relative to the newest keyframe; for the first one, its pose in the map
    /// @param is_matched           whether scans determine that pose; otherwise it is a prediction, and less certain
    void add(std::shared_ptr<const ScanPoints> scan, const Transform2& T_newest_keyframe, bool is_matched);

    /// Adds an edge that may be wrong.
    /// @param edge  between keyframes that are not neighbours
    void add_loop(const Edge& edge);

    /// Removes the loop edges for which `is_wrong` returns true.
    template <class IsWrong>
    void remove_loops(IsWrong is_wrong) {
        std::erase_if(edges_, [&](const Edge& edge) { return edge.is_robust && is_wrong(edge); });
    }

    /// Moves the keyframes so that they agree with the edges.
    /// @param iterations  at most this many steps
    void optimize(int iterations);
    /// Moves the keyframes so that they agree with the edges, with weights of loop edges that decrease in five passes.
    /// Call it after adding loop edges that correct a large drift: optimize() alone would switch them off.
    void optimize_after_jump();

    /// Returns the length of the shortest connection from a keyframe to every keyframe, in metres along edges. A loop
    /// edge counts as kLoopLength; those that are switched off are not used.
    /// @param keyframe  index below size()
    [[nodiscard]] std::vector<double> distances_from(std::size_t keyframe) const;
    static constexpr double kLoopLength = 1.0; ///< metres

    /// Returns the number of keyframes.
    [[nodiscard]] std::size_t size() const noexcept { return keyframes_.size(); }
    /// Returns a keyframe. Precondition: keyframe < size(), as in pose().
    [[nodiscard]] const Keyframe& operator[](std::size_t keyframe) const { return keyframes_[keyframe]; }
    /// Returns T_map_keyframe.
    [[nodiscard]] const Transform2& pose(std::size_t keyframe) const { return poses_[keyframe]; }
    /// Returns T_map_keyframe of all keyframes.
    [[nodiscard]] std::span<const Transform2> poses() const noexcept { return poses_; }
    /// Returns all edges, in the order in which they were added.
    [[nodiscard]] std::span<const Edge> edges() const noexcept { return edges_; }

    /// Returns some keyframes in the frame of one of them.
    /// Keyframes more than 100 m of the trajectory away from it are left out.
    /// @param first, last  the keyframes [first, last]; last < size()
    /// @param frame        the keyframe whose frame is used; views are ordered by their number of keyframes from it
    [[nodiscard]] KeyframeViews views_around(std::size_t first, std::size_t last, std::size_t frame) const;

private:
    std::vector<Keyframe> keyframes_;
    std::vector<Transform2> poses_;
    std::vector<Edge> edges_;
};

} // namespace scanloom::slam
