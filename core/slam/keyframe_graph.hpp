#pragma once

#include "core/slam/keyframe.hpp"
#include "core/slam/pose_graph.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::slam {

inline constexpr std::size_t kNoRobot = static_cast<std::size_t>(-1); ///< instead of a robot's number

// Standard deviations of the pose of a keyframe that was matched to the map around it.
inline constexpr double kFitSigma = 0.03;     ///< metres
inline constexpr double kFitTurnSigma = 0.01; ///< radians

/// Successive keyframes of one robot, each matched to those before. A robot that is lost begins another fragment.
struct Fragment {
    std::size_t robot = 0;   ///< kNoRobot: the views of a known map
    bool is_given = false;   ///< whether the poses of its keyframes are known, and do not move
    bool is_located = false; ///< whether its place in the map is known; otherwise its poses are in a frame of its own
    std::vector<std::size_t> keyframes; ///< their indices, oldest first; at least one
};

/// The keyframes of robots, their poses, and the relative poses measured between them.
/// Source: Lu, Milios, Globally Consistent Range Scan Alignment for Environment Mapping (1997).
/// Threads: one at a time.
class KeyframeGraph {
public:
    /// Begins a fragment with its first keyframe.
    /// @param robot           whose scan it is
    /// @param scan            its points
    /// @param T_map_keyframe  its pose; in a frame of its own if the fragment is not located
    /// @param is_located      whether its place in the map is known
    /// @return index of the fragment
    std::size_t begin_fragment(std::size_t robot, std::shared_ptr<const ScanPoints> scan,
                               const Transform2& T_map_keyframe, bool is_located);

    /// Adds a keyframe whose pose is known, and which does not move. Those of one robot are one fragment, which is
    /// located.
    /// @param robot           whose scan it is; kNoRobot: it is a view of a known map
    /// @param scan            its points
    /// @param T_map_keyframe  its pose
    /// @return index of the fragment
    std::size_t add_given(std::size_t robot, std::shared_ptr<const ScanPoints> scan, const Transform2& T_map_keyframe);

    /// Makes the located keyframes a map that does not change, or lets all but the given ones move again.
    /// @param is_frozen  whether the map does not change from now on
    void freeze(bool is_frozen);

    /// Returns whether a keyframe is part of the map: its fragment is located, and if the map does not change, it was
    /// when the map was frozen.
    [[nodiscard]] bool is_in_map(std::size_t keyframe) const {
        return fragment_of(keyframe).is_located && (!is_frozen_ || keyframes_[keyframe].is_fixed);
    }

    /// Returns whether the poses of two keyframes are in one frame: both are located, or of one fragment.
    [[nodiscard]] bool share_frame(std::size_t a, std::size_t b) const {
        if (keyframes_[a].fragment == keyframes_[b].fragment) return true;
        return fragment_of(a).is_located && fragment_of(b).is_located;
    }

    /// Adds a keyframe to a fragment.
    /// @param fragment           index of the fragment
    /// @param scan               its points
    /// @param T_newest_keyframe  its pose relative to the fragment's newest keyframe, as matched
    void add(std::size_t fragment, std::shared_ptr<const ScanPoints> scan, const Transform2& T_newest_keyframe);

    /// Moves a fragment as a whole.
    /// @param fragment    index of the fragment
    /// @param T_to_from   by which its poses are moved
    /// @param is_located  whether its place in the map is known then
    void move(std::size_t fragment, const Transform2& T_to_from, bool is_located);

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

    /// Returns the fragments, in the order in which they began.
    [[nodiscard]] std::span<const Fragment> fragments() const noexcept { return fragments_; }
    /// Returns the fragment of a keyframe.
    [[nodiscard]] const Fragment& fragment_of(std::size_t keyframe) const {
        return fragments_[keyframes_[keyframe].fragment];
    }

    /// Returns some keyframes of a fragment in the frame of one of them.
    /// Keyframes more than kMapRadius away from it, along the trajectory or in a straight line, are left out.
    /// @param frame        the keyframe whose frame is used; views are ordered by their number of keyframes from it
    /// @param first, last  positions [first, last] in its fragment
    [[nodiscard]] KeyframeViews views_around(std::size_t frame, std::size_t first, std::size_t last) const;

    /// Returns the keyframe whose pose is nearest to a pose, of those for which `is_wanted` returns true; nullopt: it
    /// does for none. A turn of one radian counts as one metre.
    template <class IsWanted>
    [[nodiscard]] std::optional<std::size_t> nearest(const Transform2& T_map_robot, IsWanted is_wanted) const {
        std::optional<std::size_t> nearest;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t n = 0; n < size(); ++n) {
            if (!is_wanted(n)) continue;
            const Transform2 off = inverse(poses_[n]) * T_map_robot;
            const double distance = distance_of(off) + std::fabs(yaw_of(off));
            if (distance >= least) continue;
            least = distance;
            nearest = n;
        }
        return nearest;
    }

    /// Returns the keyframes of the map that are nearest to one of them, in its frame. Of keyframes with almost equal
    /// poses it takes one.
    /// @param frame          the keyframe whose frame is used
    /// @param count          at most this many keyframes
    /// @param T_frame_robot  the center of the map; keyframes more than kMapRadius away from it are left out
    [[nodiscard]] KeyframeViews views_near(std::size_t frame, std::size_t count, const Transform2& T_frame_robot) const;

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.fragments_, self.keyframes_, self.poses_, self.edges_, self.newest_given_, self.is_frozen_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent() const;

private:
    [[nodiscard]] std::vector<std::size_t> fixed() const;

    std::vector<Fragment> fragments_;
    std::vector<Keyframe> keyframes_;
    std::vector<Transform2> poses_;
    std::vector<Edge> edges_;
    std::optional<std::size_t> newest_given_; // the newest keyframe that add_given() added
    bool is_frozen_ = false;
};

} // namespace scanloom::slam
