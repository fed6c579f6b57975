#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_rules.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/classify/class_layer.hpp"
#include "core/mapping/snapshot.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace scanloom::mapping {

/// Version of the mapping algorithms. Increased when the same log would give another map; a checkpoint of another
/// version is discarded, and its log replayed.
inline constexpr std::uint32_t kProjectionVersion = 4;

/// The state of a projection without its chunks and without its trajectories, which the log contains. A checkpoint
/// stores it with the chunks.
struct ProjectionState {
    /// By sensor: its newest integrated scan with times, if the poses of the robot are estimated.
    using Turns = std::map<std::uint32_t, TrajectoryPoint>;

    /// A robot of the log, and what the projection counts of it.
    struct Robot : LoggedRobot {
        std::uint64_t scan_count = 0;          ///< scans in the trajectory
        std::optional<TrajectoryPoint> newest; ///< of the trajectory
        JumpFilter::Robot jumps;               ///< only with max_jump
        std::uint64_t excluded = 0;            ///< scans that exclusions left out
        std::uint64_t unplaced = 0;            ///< scans whose poses are not known
        EstimatedPosesView scan_poses;         ///< of its scans in the maps; empty if it sends poses
        Turns turns;                           ///< see there
    };

    Revision revision = 0;                         ///< of the newest entry that it contains
    LayerBounds bounds;                            ///< of all layers
    std::size_t pages = 0;                         ///< Projection::page_count() after restore()
    std::vector<Robot> robots;                     ///< by RobotIndex
    SharedExclusions exclusions = no_exclusions(); ///< of the log up to `revision`
    bool is_localize_only = false;                 ///< see ModeChanged
    FrameOrigin frame_origin = FrameOrigin::kOpen; ///< see LogRules::frame_origin()
    Revision corrected = 0;                        ///< see ScanPoses::corrected()
};

/// Approximate memory of one page of a projection: a chunk with its classes and its share of the trees, or a block of a
/// trajectory.
inline constexpr std::size_t kPageBytes = 20 << 10;

/// The maps of one session, derived deterministically from its log.
///
/// The same entries with the same configuration give the same cells, however the entries were batched, replayed or
/// interrupted.
/// Threads: one writer; any number of threads may read snapshots.
class Projection {
public:
    /// @param config  the session's settings
    /// @param exclusions  exclusions of the whole log that will be applied; they leave out earlier scans
    /// @param corrected  ScanPoses::corrected() of the poses that scans without poses will be given; 0: none are given
    explicit Projection(const MapConfig& config, SharedExclusions exclusions = no_exclusions(), Revision corrected = 0);

    /// Returns the session's settings.
    [[nodiscard]] const MapConfig& config() const noexcept { return config_; }
    /// Returns the revision of the newest entry that is applied; 0 if there is none.
    [[nodiscard]] Revision revision() const noexcept { return rules_.revision(); }

    /// Returns the boxes around the cells that any scan changed.
    [[nodiscard]] LayerBounds bounds() const noexcept { return {laser_.bounds(), sonar_.bounds()}; }

    /// Returns the number of chunks of laser and sonar layers.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return laser_.chunk_count() + sonar_.chunk_count(); }

    /// Returns the memory use in pages: one for each chunk and for each block of a trajectory. See kPageBytes.
    [[nodiscard]] std::size_t page_count() const noexcept;

    /// Returns how many chunks of the last snapshot have been copied for writing. While that snapshot is held, that
    /// many chunks exist in addition to chunk_count().
    [[nodiscard]] std::size_t copied_count() const noexcept { return laser_.copied() + sonar_.copied(); }

    /// Returns the robots that the log describes, by RobotIndex. Valid until the next apply().
    [[nodiscard]] const std::vector<LoggedRobot>& robots() const noexcept { return rules_.robots(); }

    /// Returns a sensor's description, or nullptr if the robot has not joined or has not described the sensor.
    /// @param robot  index in the session
    /// @param id     Sensor::id
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_of(RobotIndex robot, std::uint32_t id) const;

    /// Returns whether the next scans do not change the maps; see ModeChanged.
    [[nodiscard]] bool is_localize_only() const noexcept { return rules_.is_localize_only(); }

    /// Returns where the frame of the maps comes from.
    [[nodiscard]] FrameOrigin frame_origin() const noexcept { return rules_.frame_origin(); }

    /// Returns whether the newest entry is in no map and in no trajectory.
    /// @param robot  index in the session
    /// Precondition: the newest entry is a scan of that robot.
    [[nodiscard]] bool has_left_out_newest(RobotIndex robot) const noexcept {
        const auto& newest = robots_[robot].newest;
        return !newest || newest->revision != revision();
    }

    /// Returns the exclusions that are applied to scans; not null.
    [[nodiscard]] const SharedExclusions& exclusions() const noexcept { return filter_.exclusions(); }

    /// Returns whether the next entry excludes scans that these maps may contain, or brings excluded scans back. The
    /// log must then be replayed from its beginning with its exclusions; apply() rejects the entry.
    /// @param entry  the entry that follows revision()
    [[nodiscard]] bool is_outdated_by(const LogEntry& entry) const noexcept;

    /// Returns whether the maps depend on poses that robots did not send: any robot's poses are not Poses::kMap.
    [[nodiscard]] bool has_estimated_poses() const noexcept {
        return std::ranges::any_of(robots(), [](const auto& robot) { return robot.poses != Poses::kMap; });
    }

    /// Returns whether the entry can follow the earlier ones.
    /// @param entry  the entry that follows revision()
    /// Errors: kMalformed, as apply().
    [[nodiscard]] Result<> check(const LogEntry& entry) const { return rules_.check(entry); }

    /// Applies the next entry of the log to the maps. A scan without a pose is counted and otherwise left out.
    /// @param entry  the entry that follows revision()
    /// Errors: kMalformed if the entry cannot follow the earlier ones (an unknown robot or sensor, a seq out of order),
    ///         which occurs in damaged logs only; kConflict if is_outdated_by(entry). After an error, the projection is
    ///         unchanged.
    [[nodiscard]] Result<> apply(const LogEntry& entry);

    /// Applies the next entry of the log, or a part of a large scan: returns early when `work` is used up.
    /// @param entry  the entry that follows revision()
    /// @param work  budget in the unit of Reach::work; reduced by the work that was done
    /// @return whether the entry is completely applied; if false, repeat the call with the same entry before any other
    ///         change
    /// Errors: kMalformed if the entry cannot follow the earlier ones; kConflict if is_outdated_by(entry). After an
    ///         error, the projection is unchanged.
    [[nodiscard]] Result<bool> apply(const LogEntry& entry, double& work);

    /// Makes the maps equal to those of the same entries with other poses of scans, as a change by the newest entry:
    /// only what differs is written, and gets its revision.
    /// @param corrected  with the same settings, up to the same revision
    /// Precondition: no entry is partially applied in either.
    void replace_with(Projection corrected);

    /// Returns the maps up to revision(). Cheap; later writes copy the chunks that they change.
    [[nodiscard]] Snapshot snapshot();

    /// Returns a second, independent projection with the same contents and its own writer. Cheap: both share their
    /// chunks, and each copies those that it changes.
    /// Precondition: no entry is partially applied.
    [[nodiscard]] Projection branch();

    /// Returns the state to store in a checkpoint.
    [[nodiscard]] ProjectionState state() const;

    /// Restores a projection from a checkpoint.
    ///
    /// Call it on a new projection: first restore() with the state, then restore_laser_chunk() or restore_sonar_chunk()
    /// for every chunk, whose cells the caller fills in. Chunks may be newer than the state if writing the checkpoint
    /// was interrupted. Applying the log's entries after the state's revision then gives the same maps. The restored
    /// trajectories start with each robot's newest point; earlier points are only in the log.
    /// @param state  of a checkpoint of the same session
    void restore(const ProjectionState& state);
    /// Restores a chunk of the laser layers and returns it; the caller fills in its cells.
    [[nodiscard]] LaserChunk& restore_laser_chunk(grid::ChunkKey key, Revision revision);
    /// Restores a chunk of the sonar layer and returns it; the caller fills in its cells.
    [[nodiscard]] SonarChunk& restore_sonar_chunk(grid::ChunkKey key, Revision revision);

    /// Returns the newest revision of the restored chunks. If the log has fewer entries, the chunks belong to another
    /// log.
    [[nodiscard]] Revision newest_restored() const noexcept {
        return std::max(laser_.newest_restored(), sonar_.newest_restored());
    }

private:
    /// The beam directions of a sensor's own angles, reused for scans with the same number of beams.
    struct KnownFan {
        std::size_t beams = 0;
        std::variant<LaserFan, SonarFan> fan;
    };

    /// The state of one robot.
    struct Robot {
        [[nodiscard]] Robot branch() const;

        std::uint64_t scan_count = 0; // in the trajectory
        std::uint64_t excluded = 0;
        std::uint64_t unplaced = 0;
        std::optional<TrajectoryPoint> newest; // of its integrated scans
        Trajectory trajectory;
        EstimatedPoses poses; // of its scans; empty if it sends poses
        ProjectionState::Turns turns;
        std::map<std::uint32_t, KnownFan> fans;
    };

    Projection(const MapConfig& config, SharedExclusions exclusions, LaserLayers laser, SonarLayer sonar,
               classify::ClassLayer classes);

    bool integrate_entry(const RobotJoined& joined, double& work);
    bool integrate_entry(const SensorDescribed& described, double& work);
    bool integrate_entry(const ScanTaken& taken, double& work);
    bool integrate_entry(const MapPatch& patch, double& work);
    bool integrate_entry(const ScansExcluded& excluded, double& work);
    bool integrate_entry(const ExclusionLifted& lifted, double& work);
    bool integrate_entry(const MapsCorrected& corrected, double& work);
    bool integrate_entry(const RobotRelocalized& relocalized, double& work);
    bool integrate_entry(const ModeChanged& changed, double& work);
    [[nodiscard]] std::optional<Scan> deskewed(const Robot& robot, const Sensor& sensor, const ScanTaken& taken) const;
    [[nodiscard]] const KnownFan& fan_of(Robot& robot, const Sensor& sensor, const Scan& scan);

    void bring_classes_up_to(const LaserView& laser);

    MapConfig config_;
    LogRules rules_;
    LaserLayers laser_;
    SonarLayer sonar_;
    classify::ClassLayer classes_;
    Revision classes_at_ = 0;   // the classes match the laser chunks at this revision
    std::vector<Robot> robots_; // by RobotIndex, as many as in rules_
    ScanFilter filter_;
    Revision corrected_ = 0;   // see ScanPoses::corrected()
    bool is_applying_ = false; // a scan is partially integrated
};

} // namespace scanloom::mapping
