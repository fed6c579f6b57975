#pragma once

#include "common/error/error.hpp"
#include "core/localization/localized_projection.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::localization {

/// Version of the algorithms that estimate poses, and of EstimationState. Increased when the same log would give other
/// poses or other bytes; a state of another version is discarded, and the poses are estimated again.
inline constexpr std::uint32_t kEstimationVersion = 7;

using SharedScan = std::shared_ptr<const slam::ScanPoints>;  ///< the points of a keyframe, which never change
using SharedCorrection = std::shared_ptr<const GraphMoment>; ///< it never changes, either

/// What decides how the estimation of a session's poses goes on, to be stored. What follows from it is left out: the
/// maps that scans are matched to are made again from their views.
/// Threads: any. Its objects do not change.
struct EstimationState {
    std::string bytes;             ///< everything but the scans and the corrections, of which it has numbers
    std::vector<SharedScan> scans; ///< of the keyframes, in their order: only more are added
    std::vector<SharedCorrection> corrections;       ///< by correction of the maps: only more are added
    std::vector<mapping::Localization> localization; ///< by RobotIndex; follows from the rest
};

/// Returns the state.
/// Cost: a copy of some 250 bytes for each scan.
[[nodiscard]] EstimationState state_of(const LocalizedProjection& maps);

/// Returns the poses, and what led to them, without the maps: equal for equal entries of a log.
[[nodiscard]] EstimationState state_of(const SessionPoses& poses);

/// Returns whether poses, and what led to them, are equal bit by bit.
[[nodiscard]] bool are_equal(const SessionPoses& a, const SessionPoses& b);

/// A state that was read.
struct RestoredEstimation {
    SessionPoses poses;     ///< of all scans
    Revision shown = 0;     ///< LocalizedProjection::shown()
    Revision announced = 0; ///< LocalizedProjection::announced()
    Revision corrected = 0; ///< ProjectionState::corrected

    /// What the maps keep of a robot.
    struct Robot {
        mapping::EstimatedPoses poses;         ///< ProjectionState::Robot::scan_poses
        mapping::ProjectionState::Turns turns; ///< ProjectionState::Robot::turns
    };
    std::vector<Robot> robots; ///< by RobotIndex
};

/// Reads a state of state_of(const LocalizedProjection&).
/// @param state  its bytes may be damaged
/// @param maps   the state of the maps of the same entries, without what is restored here
/// @return nullopt if it is damaged, or not of these maps
[[nodiscard]] std::optional<RestoredEstimation> restored(const EstimationState& state,
                                                         const mapping::ProjectionState& maps);

/// Returns the points of a keyframe as bytes. Those of several may follow each other.
[[nodiscard]] std::string bytes_of(const slam::ScanPoints& scan);

/// Returns a correction as bytes.
[[nodiscard]] std::string bytes_of(const GraphMoment& correction);

/// Appends the scans that bytes_of() wrote. @return false if the bytes are damaged
[[nodiscard]] bool append_scans(std::string_view bytes, std::vector<SharedScan>& scans);

/// Appends the correction that bytes_of() wrote. @return false if the bytes are damaged
[[nodiscard]] bool append_correction(std::string_view bytes, std::vector<SharedCorrection>& corrections);

} // namespace scanloom::localization
