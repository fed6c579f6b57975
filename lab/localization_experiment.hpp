#pragma once

#include "lab/recorded_log.hpp"
#include "lab/trajectory_variants.hpp"
#include "lab/unknown_starts.hpp"
#include "server/tiles/bytes.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// How well the trajectories of recorded logs are estimated: figures and pictures.
namespace scanloom::lab {

inline constexpr std::int32_t kPictureSideMax = 1000; ///< pixels of a picture of a map

/// An estimate of a whole log.
struct EstimateResult {
    TrajectoryScore final_poses;
    TrajectoryScore first_poses; ///< each as estimated when its scan was added
    std::size_t unplaced = 0;    ///< scans whose poses are not known at the end
    double cpu_seconds = 0.0;    ///< of the estimation
};

/// An estimate of a changed log.
struct VariantResult {
    Variant variant;
    std::optional<TrajectoryScore> score; ///< of the final poses; nullopt if no relation has both its scans
    double ratio = 0.0;            ///< of its translation error to that of the plain estimate, for the same relations
    TrajectoryDistance from_plain; ///< of the final poses
};

/// The map of a log, by some poses.
struct DrawnMap {
    std::string file;       ///< in the folder for pictures
    double cell_size = 0.0; ///< metres; a pixel
    double width = 0.0;     ///< metres
    double height = 0.0;    ///< metres
};

/// The figures of a log.
struct LogResult {
    std::string name;
    std::size_t scans = 0;
    double seconds = 0.0;         ///< from the earliest stamp to the latest
    double path = 0.0;            ///< metres, by the odometry
    TrajectoryScore odometry;     ///< of the raw odometry
    EstimateResult with_odometry; ///< the plain estimate
    EstimateResult without;       ///< from the scans alone
    TrajectoryDistance without_from_plain;
    std::vector<VariantResult> variants;
    std::vector<UnknownStart> unknown_starts;
    std::array<DrawnMap, 3> maps; ///< by the raw odometry, and by the estimates with and without it; begun at one pose
};

/// What the experiment needs of its caller.
struct LocalizationHooks {
    std::function<double()> cpu_seconds; ///< CPU time of the process
    std::function<Result<>(const std::string& file, const tiles::Bytes& png)> keep_picture;
    std::function<void(std::string_view doing)> tell; ///< called before each step
};

/// Compares the raw odometry of a log with its relations. Fast: shows whether the files belong together.
/// Errors: kInvalidField if no relation counts; the message names the log.
[[nodiscard]] Result<TrajectoryScore> score_odometry(const RecordedLog& log);

/// Estimates a log with and without its odometry and in all variants_of() it, lets a second robot start anywhere in it,
/// and draws its maps.
/// Errors: as score_odometry(); those of draw_map() and keep_picture; kNotFound if a variant leaves no scan. Messages
///         name the log.
[[nodiscard]] Result<LogResult> run_localization(const RecordedLog& log, const LocalizationHooks& hooks);

} // namespace scanloom::lab
