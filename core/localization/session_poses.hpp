#pragma once

#include "core/localization/robot_poses.hpp"
#include "core/mapping/scan_poses.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::localization {

/// Which estimate of a scan's pose.
enum class Estimate {
    kNewest, ///< with all later scans
    kFirst,  ///< when the scan was added
};

/// A robot's pose at a time.
struct StampedPose {
    double stamp = 0.0; ///< seconds
    Pose2 pose;         ///< T_map_robot

    friend bool operator==(const StampedPose&, const StampedPose&) = default;
};

/// The pose graph of a session's robots.
struct PoseGraphView {
    /// A keyframe.
    struct Node {
        RobotIndex robot = 0;    ///< whose scan it is
        Pose2 pose;              ///< T_map_keyframe
        bool is_located = false; ///< whether its place in the map is known; otherwise the pose is in another frame
    };
    std::vector<Node> keyframes;   ///< of all robots, in the order in which they were added
    std::vector<slam::Edge> edges; ///< between them
};

/// The poses of the scans of all robots of a session that do not send poses in the map frame: a projection of the log,
/// like the maps. Equal entries give equal poses.
/// Threads: one at a time.
class SessionPoses {
public:
    /// Begins with a map whose frame is given, that of an imported map or of robots that send their poses: all robots
    /// are located in it.
    /// @param views        of the map so far
    /// @param is_imported  see SharedMap::begin_with()
    void begin_with(std::vector<slam::KnownView> views, bool is_imported) {
        map_->begin_with(std::move(views), is_imported);
    }

    /// Returns whether begin_with() was called.
    [[nodiscard]] bool is_frame_given() const noexcept { return map_->is_frame_given(); }

    /// Adds a scan of a robot that sends its poses to the map in which the others are located. Before the first scan
    /// with an estimated pose it does nothing, because begin_with() gets the whole map so far.
    /// @param taken   the scan, with its pose
    /// @param sensor  that took it
    void add_given(const ScanTaken& taken, const Sensor& sensor);

    /// Estimates the pose of the log's next scan, and sets it. Without a pose, it fits no place.
    /// @param taken     the scan
    /// @param sensor    that took it
    /// @param revision  of the entry
    void estimate(ScanTaken& taken, const Sensor& sensor, Revision revision);

    /// Adds the log's next scan, which is excluded: it has no pose, and changes those of no other scan.
    /// @param taken     the scan, whose pose is removed
    /// @param revision  of the entry
    void leave_out(ScanTaken& taken, Revision revision);

    /// Searches for the robot's next scan near a place.
    void relocalize(const RobotRelocalized& relocalized);

    /// Freezes the map that the robots share, so that further scans only show where they are, or lets it change again.
    /// @param is_localize_only  whether it is frozen from now on
    /// @param revision          of the entry; the maps then show the newest estimates, because they stay as they are
    void change_mode(bool is_localize_only, Revision revision);

    /// Returns the newest entry at which the poses of earlier scans in the maps were corrected; 0: none were.
    [[nodiscard]] Revision corrected() const noexcept { return corrected_; }

    /// Returns the poses at which maps of the entries so far show the scans.
    [[nodiscard]] mapping::ScanPoses in_maps() const;

    /// Returns the poses at which the maps of earlier entries showed the scans.
    /// Cost: a copy of what is stored of each scan.
    [[nodiscard]] PoseHistory history() const;

    /// Returns the number of scans whose poses were estimated, without the excluded ones.
    [[nodiscard]] std::size_t scan_count() const noexcept { return scan_count_; }

    /// Returns the poses of a robot's scans; nullptr if it has no scans, or sends poses.
    /// @param robot  index in the session
    [[nodiscard]] const RobotPoses* find(RobotIndex robot) const noexcept {
        return robot < robots_.size() ? robots_[robot].get() : nullptr;
    }

    /// Returns the poses of a robot's scans, in their order, without those whose place in the map is not known.
    /// @param robot     index in the session
    /// @param estimate  which poses
    /// @param exclusions  of the session, whose scans are left out
    /// @return empty if the robot sends poses
    [[nodiscard]] std::vector<StampedPose> trajectory(RobotIndex robot, Estimate estimate,
                                                      const Exclusions& exclusions = {}) const;

    /// Returns the pose graph.
    [[nodiscard]] PoseGraphView graph() const;

    /// Returns the state of the pose graph at each correction of the maps.
    [[nodiscard]] const std::vector<std::shared_ptr<const GraphMoment>>& corrections() const noexcept {
        return corrections_;
    }

    /// Returns the map that the robots share.
    [[nodiscard]] const slam::SharedMap& map() const noexcept { return *map_; }

    /// Returns the number of robots, including those that send poses but are followed by others.
    [[nodiscard]] std::size_t robot_count() const noexcept { return robots_.size(); }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(*self.map_, self.corrected_, self.corrections_, self.scan_count_, self.given_);
        auto count = static_cast<RobotIndex>(self.robots_.size());
        archive(count);
        for (RobotIndex robot = 0; robot < count; ++robot) {
            bool is_estimated = self.find(robot) != nullptr;
            archive(is_estimated);
            if constexpr (Archive::kReads) {
                if (archive.failed()) return;
                self.robots_.push_back(is_estimated ? std::make_unique<RobotPoses>(*self.map_, robot) : nullptr);
            }
            if (is_estimated) archive(*self.robots_[robot]);
        }
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent() const;

private:
    [[nodiscard]] RobotPoses& poses_of(RobotIndex robot);
    void correct(Revision revision);

    std::unique_ptr<slam::SharedMap> map_ = std::make_unique<slam::SharedMap>();
    std::vector<std::unique_ptr<RobotPoses>> robots_; // by RobotIndex; null: as find()
    Revision corrected_ = 0;
    std::vector<std::shared_ptr<const GraphMoment>> corrections_;
    std::size_t scan_count_ = 0;
    std::map<RobotIndex, scan_matching::Transform2> given_; // newest keyframes of robots that send their poses
};

} // namespace scanloom::localization
