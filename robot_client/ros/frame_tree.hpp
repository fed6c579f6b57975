#pragma once

#include "robot_client/ros/messages.hpp"

#include <Eigen/Geometry>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

namespace scanloom::robot {

/// Why the pose of a frame in another one is not known at a time.
enum class NoTransform {
    kNotConnected, ///< at this time no transforms lead from one to the other
    kBefore,       ///< a transform begins later: nothing is extrapolated
    kAfter,        ///< a transform ends earlier
    kHole,         ///< a transform changes during a hole of more than FrameTree::kHoleMax
    kLoop,         ///< they lead only through frames that are above themselves
};

/// A time by the clock of a robot, which may have been set back.
struct EpochTime {
    // NOLINTNEXTLINE(google-explicit-constructor): most clocks are not set back
    constexpr EpochTime(RosTime at, std::uint32_t in_epoch = 0) : epoch(in_epoch), stamp(at) {}

    std::uint32_t epoch; ///< how often the clock was set back before, see StampEpochs
    RosTime stamp;

    friend constexpr auto operator<=>(const EpochTime&, const EpochTime&) = default;
};

/// The frames of a recording and the transforms between them over time, as /tf and /tf_static have them. Poses are
/// interpolated between two stamps of an epoch and never extrapolated. A frame has one parent at a time. Where a child
/// has no transforms of an epoch around a time, those of the nearest epoch that has are used: messages of different
/// rates may not notice that a clock was set.
/// Threads: one at a time; lookups at the same time.
class FrameTree {
public:
    /// Transforms farther apart in time are not interpolated unless they are equal: the robot may have been anywhere.
    static constexpr RosTime kHoleMax = 2'000'000'000; // nanoseconds

    /// Frames of a tree that forgets; transforms of further frames are not added.
    static constexpr std::size_t kFramesMax = 10'000;

    /// Makes the tree forget, so that its size stays bounded while transforms of a live robot come: of each child it
    /// keeps those of a time before the newest one, and the last one before that. A transform whose stamp lies more
    /// than kSetBack before the newest one of its child replaces all: the robot's clock was set back.
    /// @param kept  nanoseconds
    void forget_before_newest(RosTime kept) { kept_ = kept; }

    /// Adds a transform. Of several with the same child and stamp the first counts. Transforms may come in any order.
    /// @param is_static  it holds at all times, and replaces all others of its child
    /// @param epoch      of its stamp
    void add(const RosTransform& transform, bool is_static, std::uint32_t epoch = 0);

    /// Makes all stamps those of one epoch, as if the clock was never set back.
    void join_epochs();

    /// Returns the pose of a frame in another one.
    /// @param target,source  names of frames
    /// @return T_target_source
    [[nodiscard]] std::variant<Eigen::Isometry3d, NoTransform> find(std::string_view target, std::string_view source,
                                                                    EpochTime time) const;

    /// Returns a frame and the frames above it by the newest transforms: its parent, the parent of that, and so on. The
    /// list ends before a frame that it has already.
    [[nodiscard]] std::vector<std::string> ancestors(std::string_view frame) const;

    /// Returns the frames whose newest parent fulfils a condition.
    [[nodiscard]] std::set<std::string> children_of(bool (*is_parent)(std::string_view)) const;

    /// Returns the names of all frames.
    [[nodiscard]] const std::vector<std::string>& frames() const noexcept { return names_; }

    /// Returns whether a frame moves in its parent, or changes it.
    [[nodiscard]] bool moves(std::string_view child) const;

    /// Returns whether the transform of a frame to its parent holds at all times.
    [[nodiscard]] bool is_static(std::string_view child) const;

    /// Removes the frames that are above none of these.
    void keep_ancestors(const std::set<std::string>& frames);

    /// Replaces the transforms of a child by those of a child in another tree.
    void replace(const std::string& child, const FrameTree& other, const std::string& other_child);

    /// Adds the transforms of another tree, but of children that this one has.
    void merge(const FrameTree& other);

    /// Returns the number of transforms in memory. Of equal transforms in a row, the first and the last are kept.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Returns whether a frame has a parent, or is one.
    [[nodiscard]] bool has(std::string_view frame) const { return ids_.contains(std::string(frame)); }

private:
    /// Where an epoch has no transforms so far from a time, those of others are looked for.
    static constexpr RosTime kEpochMargin = 2'000'000'000; // nanoseconds
    static constexpr RosTime kSetBack = 1'000'000'000;     // nanoseconds; stamps of live transforms jitter less

    using Frame = std::uint32_t; // index in names_

    struct Transform {
        Frame parent;
        Eigen::Vector3d translation;
        Eigen::Quaterniond rotation;
    };

    /// The transforms of a child to its parents.
    struct Edge {
        std::optional<Transform> fixed;
        std::map<EpochTime, Transform> moving;
    };

    /// A frame above another one.
    struct Step {
        Frame frame;
        Eigen::Isometry3d T_frame_source;
    };

    [[nodiscard]] static Frame newest_parent(const Edge& edge) {
        return edge.fixed ? edge.fixed->parent : edge.moving.rbegin()->second.parent;
    }
    [[nodiscard]] static bool are_equal(const Transform& a, const Transform& b);
    [[nodiscard]] Frame id_of(const std::string& name);
    [[nodiscard]] const Edge* edge_of(std::string_view child) const;
    [[nodiscard]] static std::variant<Transform, NoTransform> at(const Edge& edge, EpochTime time);
    [[nodiscard]] static std::variant<Transform, NoTransform> at_in_epoch(const Edge& edge, EpochTime time);
    [[nodiscard]] static bool has_near(const Edge& edge, EpochTime time);
    [[nodiscard]] static std::vector<std::uint32_t> epochs_near(const Edge& edge, std::uint32_t epoch);
    [[nodiscard]] std::optional<NoTransform> climb(Frame frame, EpochTime time, std::vector<Step>& steps) const;
    void insert(Edge& edge, EpochTime time, const Transform& one);
    void forget(Edge& edge);

    void count();

    std::vector<std::string> names_;
    std::unordered_map<std::string, Frame> ids_;
    std::unordered_map<Frame, Edge> edges_; // by child
    std::size_t size_ = 0;
    std::optional<RosTime> kept_; // forget_before_newest()
};

} // namespace scanloom::robot
