#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/scan_filter.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom {

/// A sensor as described by a log entry. The description is shared and never changes.
struct KnownSensor {
    Revision revision = 0;                ///< of that entry, or of a later checkpoint
    std::shared_ptr<const Sensor> sensor; ///< not null
};

/// A robot as described by the entries of a log up to one of them.
struct LoggedRobot {
    std::string name;                             ///< RobotJoined::name
    std::string source;                           ///< RobotJoined::source
    std::optional<double> body_radius;            ///< RobotJoined::body_radius
    Poses poses = Poses::kMap;                    ///< RobotJoined::poses
    std::uint64_t last_seq = 0;                   ///< of its newest scan; 0 if it has none
    std::map<std::uint32_t, KnownSensor> sensors; ///< by id

    /// Returns whether the robot may join again with this source and these poses: all scans of a robot come from one
    /// source, and have poses of one kind.
    [[nodiscard]] bool accepts(const std::string& other_source, Poses other_poses) const {
        return last_seq == 0 || (source == other_source && poses == other_poses);
    }

    /// Returns whether a scan with this seq follows the robot's newest scan.
    [[nodiscard]] bool is_next(std::uint64_t seq) const noexcept { return seq == last_seq + 1; }

    /// Returns the sensor with this id; nullptr if the robot has not described it.
    [[nodiscard]] const KnownSensor* find_sensor(std::uint32_t id) const noexcept {
        const auto found = sensors.find(id);
        return found == sensors.end() ? nullptr : &found->second;
    }
};

/// Where the frame of a session's map comes from.
enum class FrameOrigin {
    kOpen,      ///< the session has no map yet
    kImported,  ///< an imported map
    kSent,      ///< the poses that robots sent (Poses::kMap)
    kEstimated, ///< the first scan of a robot whose poses the server estimates
};

/// Decides which entry may come next in a session's log, and keeps the state that this depends on.
class LogRules {
public:
    LogRules() = default;

    /// Restores the state after the entry with this revision from a checkpoint.
    /// @param revision    of the newest entry that the state contains
    /// @param robots      by RobotIndex
    /// @param exclusions  of the log up to `revision`
    /// @param is_localize_only  see is_localize_only()
    /// @param frame_origin   see frame_origin()
    LogRules(Revision revision, std::vector<LoggedRobot> robots, Exclusions exclusions, bool is_localize_only,
             FrameOrigin frame_origin)
        : revision_(revision), robots_(std::move(robots)), exclusions_(std::move(exclusions)),
          is_localize_only_(is_localize_only), frame_origin_(frame_origin) {}

    /// Checks whether `entry` can be the next one.
    /// Errors: kMalformed if it cannot, which happens only in a damaged log.
    [[nodiscard]] Result<> check(const LogEntry& entry) const;

    /// Applies the next entry. Precondition: check(entry) succeeds.
    void apply(const LogEntry& entry);

    /// Checks the next entry and applies it if check() succeeds.
    /// Errors: those of check().
    [[nodiscard]] Result<> add(const LogEntry& entry);

    /// Resets one robot to an earlier state, because its newest entries do not get into the log. revision() is not
    /// changed; frame_origin() is found again if the robot's scans decided it.
    /// @param robot  index in the session
    /// @param state  the robot before those entries
    void reset_robot(RobotIndex robot, LoggedRobot state);

    /// Returns the revision of the newest entry.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Returns the robots, by RobotIndex.
    [[nodiscard]] const std::vector<LoggedRobot>& robots() const noexcept { return robots_; }

    /// Returns the exclusions of the log, including those that were lifted.
    [[nodiscard]] const Exclusions& exclusions() const noexcept { return exclusions_; }

    /// Returns whether the next scans do not change the map; see ModeChanged.
    [[nodiscard]] bool is_localize_only() const noexcept { return is_localize_only_; }

    /// Returns where the frame of the map comes from.
    [[nodiscard]] FrameOrigin frame_origin() const noexcept { return frame_origin_; }

    /// Returns the first robot that has scans and sends its poses (Poses::kMap); nullptr: there is none.
    [[nodiscard]] const LoggedRobot* find_sender() const noexcept { return find_robot(true); }

    /// Returns the first robot that has scans, and whose poses the server estimates; nullptr: there is none.
    [[nodiscard]] const LoggedRobot* find_estimated() const noexcept { return find_robot(false); }

private:
    [[nodiscard]] const LoggedRobot* find_robot(bool sends_poses) const noexcept;
    [[nodiscard]] FrameOrigin origin_of_mapped() const noexcept;
    [[nodiscard]] Result<> check_body(const RobotJoined& joined) const;
    [[nodiscard]] Result<> check_body(const SensorDescribed& described) const;
    [[nodiscard]] Result<> check_body(const ScanTaken& taken) const;
    [[nodiscard]] Result<> check_body(const MapPatch& patch) const;
    [[nodiscard]] Result<> check_body(const ScansExcluded& excluded) const;
    [[nodiscard]] Result<> check_body(const ExclusionLifted& lifted) const;
    [[nodiscard]] Result<> check_body(const MapsCorrected& corrected) const;
    [[nodiscard]] Result<> check_body(const RobotRelocalized& relocalized) const;
    [[nodiscard]] Result<> check_body(const ModeChanged& changed) const;
    void apply_body(const RobotJoined& joined);
    void apply_body(const SensorDescribed& described);
    void apply_body(const ScanTaken& taken);
    void apply_body(const MapPatch& patch);
    void apply_body(const ScansExcluded& excluded);
    void apply_body(const ExclusionLifted& lifted);
    void apply_body(const MapsCorrected& corrected);
    void apply_body(const RobotRelocalized& relocalized);
    void apply_body(const ModeChanged& changed);

    Revision revision_ = 0;
    std::vector<LoggedRobot> robots_;
    Exclusions exclusions_;
    bool is_localize_only_ = false;
    FrameOrigin frame_origin_ = FrameOrigin::kOpen;
};

} // namespace scanloom
