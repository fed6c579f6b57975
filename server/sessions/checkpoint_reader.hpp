#pragma once

#include "common/error/error.hpp"
#include "core/localization/localized_projection.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/checkpoint_estimation.hpp"
#include "server/sessions/checkpoint_parts.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

/// Restores the maps, and the estimation of poses, from the parts of a checkpoint.
class CheckpointReader {
public:
    explicit CheckpointReader(const mapping::MapConfig& config) : projection_(config) {}

    /// Adds the next part, in ascending order of keys. After an error, replay the whole log instead.
    /// Errors: kMalformed if the part is damaged; kUnsupportedVersion if it was written by another version, whose maps
    /// may differ.
    [[nodiscard]] Result<> add(std::string_view key, std::string_view value);

    /// Returns the maps at the revision of the checkpoint; empty ones if no part was added.
    /// Errors: kMalformed if parts are missing.
    [[nodiscard]] Result<localization::LocalizedProjection> finish() &&;

    /// Returns whether the parts have the format that this program writes. If not, the next checkpoint must replace all
    /// parts.
    [[nodiscard]] bool is_newest_format() const noexcept;

    /// The first key after the parts of the state. Parts from this key on are sensors, the estimation and cells.
    static constexpr std::string_view kAfterState = "sensor/";

    /// Returns how well the poses of each robot are known, by RobotIndex; empty if no robot's are estimated. Call it as
    /// state().
    [[nodiscard]] std::vector<mapping::Localization> localization() const;

    /// Returns the state without sensors; an empty one if no part was added. Call after all parts before kAfterState.
    /// @return nullopt if the checkpoint was written in an earlier format, which does not contain the whole state
    [[nodiscard]] std::optional<mapping::ProjectionState> state() &&;

private:
    using Numbers = std::vector<std::uint32_t>; // those in a key

    /// A kind of part, identified by the prefix of its key. `add` returns false if the part is damaged.
    struct Kind {
        std::string_view prefix;
        std::size_t numbers;
        bool (CheckpointReader::*add)(const Numbers& numbers, std::string_view value);
    };
    static const Kind kKinds[5];

    [[nodiscard]] Result<> add_format(std::string_view value);
    [[nodiscard]] Result<> add_head(std::string_view value);
    [[nodiscard]] Result<> add_estimation_head(std::string_view value);
    [[nodiscard]] Result<> add_exclusions(std::string_view value);
    [[nodiscard]] bool add_robot(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_sensor(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_old_points(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_laser_chunk(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_sonar_chunk(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool restore_projection();

    PartDecompressor decompressor_;
    mapping::Projection projection_;
    mapping::ProjectionState state_;
    std::vector<std::uint64_t> excluded_; // scans, by robot
    std::optional<EstimationReader> estimation_;
    std::optional<localization::RestoredEstimation> restored_; // of estimation_
    std::uint32_t parts_version_ = 0;
    bool has_format_ = false;
    bool is_restored_ = false; // the state is complete and was passed to the projection
};

} // namespace scanloom::sessions
