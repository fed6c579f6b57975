#pragma once

#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/pose_path.hpp"
#include "robot_client/sources/source.hpp"

#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace scanloom::robot {

struct SonarOptions {
    NoReturn no_return = NoReturn::kFree;     ///< readings at the end of the range are real no-returns
    double range_max = 5.11;                  ///< metres; these files write 5110 for a no-return
    double aperture = std::numbers::pi / 6.0; ///< radians, full width of a cone
    LineLimits limits;
    Poses poses = Poses::kMap; ///< kMap or kOdometry: what the poses of the file are
};

/// A ring of eight sonars recorded in two text files, as a source: one sensor with eight beams, one scan for each line
/// of measurements, in the order of that file.
///
/// - Measurements: `time_ms r1 .. r8`, whole milliseconds and millimetres. Readings of at least range_max are
///   no-returns, readings of 0 or less failed.
/// - Poses: `time_ms x y heading`, millimetres and tenths of a degree. A scan's pose is interpolated between the poses
///   around its time. It is the scan's odometry if SonarOptions::poses is kOdometry.
///
/// Frames: heading and beam angles are counter-clockwise. Beams 1 to 8 point to -90, -37.5, -22.5, -7.5, 7.5, 22.5,
///         37.5 and 90 degrees, so the first one points to the right. The files do not state this. It was determined
///         from a recording of 413 lines by trying both signs of both. The driven direction agrees with the heading as
///         it is (mean cosine of the angle between them 0.99995, mirrored 0.28). With that heading, the 2,236 echoes
///         fall into the fewest cells of 0.2 m if the ring is counter-clockwise (548; clockwise 626, with the heading
///         mirrored 741 and 755), so walls observed twice coincide.
class SonarLog final : public Source {
public:
    /// Reads both files completely.
    /// Errors: those of LineReader; kMalformed or kInvalidField if a line is not as above or a measurement has no pose
    ///         within kPoseGapMax; kNotFound if there is no line. Each names the file, and the line if there is one.
    [[nodiscard]] static Result<SonarLog> open(const std::filesystem::path& measurements,
                                               const std::filesystem::path& poses, const SonarOptions& options);

    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return scans_.size(); }

    /// Returns at most 64 printable bytes that are the same for the same scans, whatever the files' names.
    [[nodiscard]] const std::string& fingerprint() const noexcept { return fingerprint_; }

private:
    SonarLog(Sensor ring, std::vector<Scan> scans, std::string fingerprint)
        : ring_(std::make_shared<const Sensor>(std::move(ring))), scans_(std::move(scans)),
          fingerprint_(std::move(fingerprint)) {}

    std::shared_ptr<const Sensor> ring_;
    std::vector<Scan> scans_;
    std::string fingerprint_;
    std::size_t next_ = 0;
};

} // namespace scanloom::robot
