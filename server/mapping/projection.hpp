#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_rules.hpp"
#include "common/scan/scan_filter.hpp"
#include "server/classify/class_layer.hpp"
#include "server/mapping/snapshot.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace scanloom::mapping {

/// Rises when the same log would give another map; checkpoints of another version are woven anew.
inline constexpr std::uint32_t kWeavingVersion = 4;

/// Everything but the chunks of a projection, and its trajectories, which the log has: what a checkpoint keeps besides
/// the chunks.
struct ProjectionState {
    struct Robot : LoggedRobot {
        std::uint64_t scan_count = 0;          ///< integrated
        std::optional<TrajectoryPoint> newest; ///< of those
        JumpFilter::Robot jumps;               ///< only with max_jump
        std::uint64_t excluded = 0;            ///< scans
    };

    Revision revision = 0;
    LayerBounds bounds;
    std::size_t pages = 0; ///< Projection::page_count() of what is read back
    std::vector<Robot> robots;
    SharedExclusions exclusions = no_exclusions();
};

/// What a page of a projection takes in memory, about: a chunk with its classes and its share of the trees, or a block
/// of a trajectory.
inline constexpr std::size_t kPageBytes = 20 << 10;

/// The maps of one session: a deterministic fold of its log.
///
/// Whatever way the entries were batched, replayed or interrupted, the same entries under the same
/// configuration give the same cells.
/// Thread  one writer; snapshots are for everybody.
class Projection {
public:
    /// @param exclusions  of the whole log that will be folded: they leave out scans that are before them
    explicit Projection(const MapConfig& config, SharedExclusions exclusions = no_exclusions());

    [[nodiscard]] const MapConfig& config() const noexcept { return config_; }
    [[nodiscard]] Revision revision() const noexcept { return rules_.revision(); }

    /// The cells that any scan changed.
    [[nodiscard]] LayerBounds bounds() const noexcept { return {laser_.bounds(), sonar_.bounds()}; }

    /// Of lasers and sonars.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return laser_.chunk_count() + sonar_.chunk_count(); }

    /// What it takes of memory, in pages: each chunk and each block of a trajectory is one.
    [[nodiscard]] std::size_t page_count() const noexcept;

    /// Of the chunks of the last snapshot, those that have been copied since, to be written: as long as that snapshot
    /// is held, there are so many more than chunk_count().
    [[nodiscard]] std::size_t copied_count() const noexcept { return laser_.copied() + sonar_.copied(); }

    /// The robots as the log describes them, by RobotIndex. Valid until the next fold().
    [[nodiscard]] const std::vector<LoggedRobot>& robots() const noexcept { return rules_.robots(); }

    /// Null: no such robot has joined, or it has described no such sensor.
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_of(RobotIndex robot, std::uint32_t id) const;

    /// Whether the newest entry was not integrated. Pre  it is a scan of that robot.
    [[nodiscard]] bool has_left_out_newest(RobotIndex robot) const noexcept {
        const auto& newest = robots_[robot].newest;
        return !newest || newest->revision != revision();
    }

    [[nodiscard]] const SharedExclusions& exclusions() const noexcept { return filter_.exclusions(); }

    /// Whether the next entry excludes scans that may be in these maps, or brings some back: then the log is to be
    /// folded from its beginning, with its exclusions. fold() refuses such an entry with kConflict.
    [[nodiscard]] bool is_outdated_by(const LogEntry& entry) const noexcept;

    /// Adds the next entry of the log.
    /// Errors  kMalformed: an entry that cannot follow the earlier ones (an unknown robot or sensor,
    ///         a seq out of order); the projection is unchanged. Only a damaged log has such entries.
    [[nodiscard]] Result<> fold(const LogEntry& entry);

    /// The same, but gives way within a large scan: when `work` (as Reach::work) is used up, what was used being
    /// taken from it.
    /// @return whether the entry is in; until then nothing but the same call may follow.
    [[nodiscard]] Result<bool> fold(const LogEntry& entry, double& work);

    /// What has been woven so far. Cheap; the next writes copy the chunks they touch.
    [[nodiscard]] Snapshot snapshot();

    /// A second projection that goes on from here by itself, with a writer of its own. Cheap: both share what there is,
    /// and copy the chunks that they touch next.
    /// Pre  not within a scan.
    [[nodiscard]] Projection branch();

    [[nodiscard]] ProjectionState state() const;

    /// Rebuilds a projection from a checkpoint. Call on a fresh projection: first the state, then every chunk (whose
    /// cells the caller fills in). Chunks may be newer than the state (a checkpoint cut short): folding the log's
    /// entries after the state's revision then gives the same maps. Its trajectories begin behind the state.
    void restore(const ProjectionState& state);
    [[nodiscard]] LaserChunk& restore_laser_chunk(grid::ChunkKey key, Revision revision);
    [[nodiscard]] SonarChunk& restore_sonar_chunk(grid::ChunkKey key, Revision revision);

    /// The log has at least this many entries, or the chunks put back were of another log.
    [[nodiscard]] Revision newest_restored() const noexcept {
        return std::max(laser_.newest_restored(), sonar_.newest_restored());
    }

private:
    /// The fan of a sensor's own angles, kept from scan to scan of the same beam count.
    struct KnownFan {
        std::size_t beams = 0;
        std::variant<LaserFan, SonarFan> fan;
    };

    /// What the maps hold of a robot.
    struct Robot {
        [[nodiscard]] Robot branch() const;

        std::uint64_t scan_count = 0; // integrated
        std::uint64_t excluded = 0;
        std::optional<TrajectoryPoint> newest; // of its integrated scans
        Trajectory trajectory;
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
    [[nodiscard]] bool integrate(Robot& robot, const Sensor& sensor, const Scan& scan, double& work);
    [[nodiscard]] const KnownFan& fan_of(Robot& robot, const Sensor& sensor, const Scan& scan);

    void bring_classes_up_to(const LaserView& laser);

    MapConfig config_;
    LogRules rules_;
    LaserLayers laser_;
    SonarLayer sonar_;
    classify::ClassLayer classes_;
    Revision classes_at_ = 0;   // the classes are those of the laser chunks at this revision
    std::vector<Robot> robots_; // by RobotIndex, as many as in rules_
    ScanFilter filter_;
    bool is_folding_ = false; // a scan, of which a part is in
};

} // namespace scanloom::mapping
