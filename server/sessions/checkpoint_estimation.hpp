#pragma once

#include "common/error/error.hpp"
#include "core/localization/estimation_state.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/checkpoint_parts.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The parts of a checkpoint with the state from which poses are estimated. A checkpoint has them if a robot's poses
/// are estimated.
namespace scanloom::sessions {

inline constexpr std::string_view kEstimationHead = "head/estimation"; ///< key
inline constexpr std::string_view kEstimationPart = "slam/";           ///< prefix of the keys of all other parts

/// The part that agrees with the head, and says which others count.
struct EstimationHead {
    /// A robot.
    struct Robot {
        Poses poses = Poses::kMap;          ///< LoggedRobot::poses
        std::uint64_t unplaced = 0;         ///< ProjectionState::Robot::unplaced
        mapping::Localization localization; ///< as in snapshots
    };

    std::uint32_t version = localization::kEstimationVersion;
    FrameOrigin frame_origin = FrameOrigin::kOpen;
    std::uint64_t scans = 0;       ///< of keyframes
    std::uint64_t corrections = 0; ///< of the maps
    std::uint32_t slot = 0;        ///< 0 or 1: where the rest of the state is
    std::uint32_t pieces = 0;      ///< of it
    std::vector<Robot> robots;     ///< by RobotIndex
};

/// Returns the part.
[[nodiscard]] std::string estimation_head_part(const EstimationHead& head);

/// Decodes a part of estimation_head_part().
/// Errors: kMalformed if it is damaged; kUnsupportedVersion if the poses are of another version.
[[nodiscard]] Result<EstimationHead> read_estimation_head(std::string_view value);

/// Adds the parts of a state that are not stored yet, but for the head.
/// @param maps    state of the maps of the same revision
/// @param stored  the head of the stored checkpoint; nullopt: it has none. What that one needs is not overwritten
/// @param add     receives key and value, which is to be compressed
/// @return the head, which is to be stored after all other parts
[[nodiscard]] EstimationHead add_estimation(const localization::EstimationState& state,
                                            const mapping::ProjectionState& maps,
                                            const std::optional<EstimationHead>& stored,
                                            const std::function<void(std::string, std::string_view)>& add);

/// Collects the parts of a state.
class EstimationReader {
public:
    /// @param head  of the checkpoint
    explicit EstimationReader(EstimationHead head) : head_(std::move(head)) {}

    /// Adds the next part, in ascending order of keys. Ignores parts that the head does not name, as an interrupted
    /// checkpoint leaves them.
    /// @param key    without kEstimationPart
    /// @param value  compressed
    /// @return false if it is damaged
    [[nodiscard]] bool add(std::string_view key, std::string_view value, PartDecompressor& decompressor);

    /// Returns the state, and sets what maps have of it.
    /// @param maps  the state of the maps
    /// @return nullopt if parts are missing or damaged
    [[nodiscard]] std::optional<localization::RestoredEstimation> finish(mapping::ProjectionState& maps) &&;

    /// Returns the head.
    [[nodiscard]] const EstimationHead& head() const noexcept { return head_; }

private:
    [[nodiscard]] bool add_correction(std::uint32_t number, std::uint32_t piece, std::string_view bytes);
    [[nodiscard]] bool end_correction();

    EstimationHead head_;
    localization::EstimationState state_;
    std::string correction_;              // that is being read
    std::uint32_t pieces_ = 0;            // of the state's bytes
    std::uint32_t correction_pieces_ = 0; // of correction_
};

} // namespace scanloom::sessions
