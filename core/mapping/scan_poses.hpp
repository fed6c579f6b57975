#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "core/mapping/growing_list.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::mapping {

/// T_map_robot of each scan of a robot; nullopt: it is not known.
using EstimatedPoses = GrowingList<std::optional<Pose2>>;
/// EstimatedPoses at one moment.
using EstimatedPosesView = ListView<std::optional<Pose2>>;

/// The poses of the scans that the robots of a session sent without poses, for readers of its log. Immutable, cheap to
/// copy.
/// Threads: any number of readers.
class ScanPoses {
public:
    /// What changes the poses of earlier scans. What was computed with poses of another version must be computed again.
    /// Later versions are greater.
    struct Version {
        Revision exclusions = 0; ///< Exclusions::revision() of those with which the poses were estimated
        Revision corrected = 0;  ///< newest entry at which the poses of earlier scans have changed; 0: none have

        friend auto operator<=>(const Version&, const Version&) = default;
    };

    ScanPoses() = default;
    /// @param robots  by RobotIndex; empty for a robot that sends poses
    /// @param corrected   see Version
    /// @param exclusions  see Version
    explicit ScanPoses(std::vector<EstimatedPosesView> robots, Revision corrected = 0, Revision exclusions = 0)
        : robots_(std::move(robots)), version_{exclusions, corrected} {}

    /// Returns the version of the poses.
    [[nodiscard]] const Version& version() const noexcept { return version_; }

    /// Returns version().corrected.
    [[nodiscard]] Revision corrected() const noexcept { return version_.corrected; }

    /// Sets version().exclusions.
    void set_exclusions(Revision exclusions) noexcept { version_.exclusions = exclusions; }

    /// Returns the pose of a scan, which was sent without a pose; nullopt: it is not known.
    /// @param robot  index in the session
    /// @param seq    Scan::seq
    [[nodiscard]] std::optional<Pose2> find(RobotIndex robot, std::uint64_t seq) const {
        const bool is_known = robot < robots_.size() && seq > 0 && seq <= robots_[robot].size();
        return is_known ? robots_[robot][static_cast<std::size_t>(seq - 1)] : std::nullopt;
    }

    /// Sets the pose of a scan if it has none and its pose is known.
    void place(ScanPose& scan) const {
        if (!scan.pose) scan.pose = find(scan.robot, scan.seq);
    }

    /// Sets the pose if the entry is a scan without one whose pose is known.
    void place(LogEntry& entry) const {
        auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken != nullptr && !taken->scan.pose) taken->scan.pose = find(taken->robot, taken->scan.seq);
    }

private:
    std::vector<EstimatedPosesView> robots_;
    Version version_;
};

} // namespace scanloom::mapping
