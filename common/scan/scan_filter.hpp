#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point2.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom {

/// An exclusion with the log entries that added and lifted it.
struct Exclusion {
    ScansExcluded excluded; ///< which scans it covers
    Revision since = 0;     ///< log entry that added it; it covers scans of earlier entries only
    Revision lifted = 0;    ///< log entry that lifted it; 0: in effect

    friend bool operator==(const Exclusion&, const Exclusion&) = default;
};

/// The exclusions of a session's log up to one of its entries.
class Exclusions {
public:
    static constexpr std::size_t kMost = 1000; ///< largest number in effect at a time; add() does not check it

    /// Checks whether the entry can follow.
    /// @param excluded  the next entry of the log
    /// Errors: kMalformed if its id is not greater than all earlier ones.
    [[nodiscard]] Result<> check(const ScansExcluded& excluded) const;

    /// Checks whether the entry can follow.
    /// @param lifted  the next entry of the log
    /// Errors: kMalformed if no exclusion with its id is in effect.
    [[nodiscard]] Result<> check(const ExclusionLifted& lifted) const;

    /// Adds the log entry with this revision.
    /// @param revision  of this entry; greater than those of earlier ones
    /// @param excluded  the entry
    /// Errors: those of check().
    [[nodiscard]] Result<> add(Revision revision, const ScansExcluded& excluded);

    /// Adds the log entry with this revision.
    /// @param revision  of this entry; greater than those of earlier ones
    /// @param lifted    the entry
    /// Errors: those of check().
    [[nodiscard]] Result<> add(Revision revision, const ExclusionLifted& lifted);

    /// Returns whether an exclusion in effect covers the scan, which is the log entry with this revision.
    [[nodiscard]] bool cover(Revision revision, const ScanPose& scan) const noexcept;

    /// Returns the revision of the newest added entry; 0 if there is none.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Returns the exclusions of the log up to and including this revision.
    [[nodiscard]] Exclusions as_of(Revision revision) const;

    /// Returns all exclusions by rising id, including those that were lifted.
    [[nodiscard]] const std::vector<Exclusion>& all() const noexcept { return all_; }
    /// Returns the number of exclusions that were not lifted.
    [[nodiscard]] std::size_t count_in_effect() const noexcept;

    friend bool operator==(const Exclusions&, const Exclusions&) = default;

private:
    std::vector<Exclusion> all_;
    Revision revision_ = 0;
};

/// Shared by a session and its snapshots; never null.
using SharedExclusions = std::shared_ptr<const Exclusions>;

/// Returns an empty set of exclusions.
[[nodiscard]] SharedExclusions no_exclusions();

/// Leaves out scans whose pose has jumped.
///
/// A scan is not integrated if it is further than max_jump both from its robot's newest integrated scan and from its
/// robot's previous scan. Therefore one wrong pose costs one scan, and so does carrying the robot to another place.
/// Distances are between positions in the map frame; the yaw does not count.
class JumpFilter {
public:
    /// The state that decides on a robot's next scan.
    struct Robot {
        std::optional<Point2> integrated; ///< position of the newest integrated scan
        std::optional<Point2> newest;     ///< position of the newest scan
        std::uint64_t left_out = 0;       ///< number of scans left out

        friend bool operator==(const Robot&, const Robot&) = default;
    };

    /// @param max_jump_m  metres; 0: all scans are integrated
    explicit JumpFilter(double max_jump_m = 0.0) : max_jump_m_(max_jump_m) {}

    /// Returns whether any scan can be left out: max_jump is not 0.
    [[nodiscard]] bool is_on() const noexcept { return max_jump_m_ > 0.0; }

    /// Returns whether the robot's next scan is integrated if it is taken at `place` (metres, map frame).
    /// @param robot  also one that has no scans yet
    /// @param place  position of the robot at the scan, metres, map frame
    [[nodiscard]] bool integrates(RobotIndex robot, const Point2& place) const noexcept;

    /// Adds the robot's next scan, taken at `place` (metres, map frame), and returns whether it is integrated.
    /// @param robot  also one that has no scans yet
    /// @param place  position of the robot at the scan, metres, map frame
    bool take(RobotIndex robot, const Point2& place);

    /// Returns the state that a checkpoint stores; the initial state for a robot without scans.
    [[nodiscard]] Robot state(RobotIndex robot) const { return robot < robots_.size() ? robots_[robot] : Robot{}; }
    /// Restores the state of a robot from a checkpoint.
    void restore(RobotIndex robot, const Robot& state);

private:
    [[nodiscard]] Robot& robot_at(RobotIndex robot);

    double max_jump_m_;
    std::vector<Robot> robots_; // by RobotIndex, up to the last robot with a scan
};

/// How a scan of the log is used.
enum class ScanUse {
    kIntegrated,
    kJump,         ///< left out because of max_jump
    kExcluded,     ///< left out because of an exclusion; max_jump ignores it
    kUnplaced,     ///< left out because its pose is not known; max_jump ignores it
    kLocalizeOnly, ///< in the trajectory only, because of localize-only mode
};

/// Returns whether the trajectory of the robot contains the scan.
[[nodiscard]] constexpr bool is_in_trajectory(ScanUse use) noexcept {
    return use == ScanUse::kIntegrated || use == ScanUse::kLocalizeOnly;
}

/// Decides which scans of a log are integrated. Every projection of the log uses it, so that maps, trajectories,
/// landmarks and exports contain the same scans.
class ScanFilter {
public:
    /// @param max_jump_m  metres; 0: off
    /// @param exclusions  not null
    explicit ScanFilter(double max_jump_m = 0.0, SharedExclusions exclusions = no_exclusions())
        : exclusions_(std::move(exclusions)), jumps_(max_jump_m) {}

    /// Returns whether the use of a scan depends on the scans before it.
    [[nodiscard]] bool depends_on_earlier_scans() const noexcept { return jumps_.is_on(); }

    /// Returns how the scan is used if it is the log's next one, in the entry with this revision.
    /// @param revision  of the entry; greater than those of earlier ones
    /// @param scan      robot, seq, stamp and pose of the scan
    [[nodiscard]] ScanUse use_of(Revision revision, const ScanPose& scan) const noexcept;

    /// Adds the log's next scan, in the entry with this revision, and returns how it is used.
    /// @param revision  of the entry; greater than those of earlier ones
    /// @param scan      robot, seq, stamp and pose of the scan
    ScanUse take(Revision revision, const ScanPose& scan);

    /// Returns the exclusions that it applies; not null.
    [[nodiscard]] const SharedExclusions& exclusions() const noexcept { return exclusions_; }
    /// Returns the filter for max_jump.
    [[nodiscard]] const JumpFilter& jumps() const noexcept { return jumps_; }
    /// Returns the filter for max_jump, to restore its state.
    [[nodiscard]] JumpFilter& jumps() noexcept { return jumps_; }

private:
    SharedExclusions exclusions_;
    JumpFilter jumps_;
};

} // namespace scanloom
