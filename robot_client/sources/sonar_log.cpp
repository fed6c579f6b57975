#include "robot_client/sources/sonar_log.hpp"

#include "common/hash/sha256.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <span>

namespace scanloom::robot {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array kBeamDegrees{-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0};
constexpr double kSecondsPerMs = 1e-3;
constexpr double kMetresPerMm = 1e-3;
constexpr double kRadiansPerUnit = 0.1 * kDegree; // of a heading

Sensor make_ring(const SonarOptions& options) {
    ExplicitAngles angles;
    for (const double degrees : kBeamDegrees) angles.push_back(degrees * kDegree);
    return {0, SensorKind::kSonar, "sonar ring", Pose2{}, std::move(angles), options.aperture, 0.0, options.range_max};
}

Result<StampedPose> read_pose(std::string_view line) {
    const auto numbers = read_numbers(split(line), 4, "time_ms x y heading");
    if (!numbers) return numbers.error();
    const auto& n = *numbers;
    return stamped_pose(n[1] * kMetresPerMm, n[2] * kMetresPerMm, n[3] * kRadiansPerUnit, n[0] * kSecondsPerMs);
}

Result<Scan> read_measurement(std::string_view line, const SonarOptions& options) {
    const auto numbers = read_numbers(split(line), 1 + kBeamDegrees.size(), "time_ms and 8 ranges in mm");
    if (!numbers) return numbers.error();
    Scan scan;
    scan.stamp = numbers->front() * kSecondsPerMs;
    const RangeMm range_max_mm = to_range_mm(options.range_max);
    for (const double mm : std::span(*numbers).subspan(1)) {
        const RangeMm range = to_range_mm(mm * kMetresPerMm);
        const RangeMm no_return = options.no_return == NoReturn::kFree ? kNoReturn : kInvalidRange;
        scan.ranges.push_back(range < range_max_mm ? range : no_return);
    }
    return scan;
}

/// Calls `take` for each line that is not blank; its errors get the file and the line number as prefix.
Result<> read_lines(const std::filesystem::path& path, LineLimits limits, Sha256& hash,
                    const std::function<Result<>(std::string_view line)>& take) {
    auto lines = LineReader::open(path, limits);
    if (!lines) return lines.error();
    bool is_empty = true;
    for (;;) {
        const auto line = lines->next();
        if (!line) return line.error();
        if (!*line) break;
        if (split(**line).empty()) continue;
        is_empty = false;
        hash.update(**line);
        hash.update("\n");
        if (auto taken = take(**line); !taken) {
            return prefixed(fmt::format("{}:{}: ", path.string(), lines->line_number()), taken.error());
        }
    }
    if (!is_empty) return {};
    return Error{Errc::kNotFound, fmt::format("{}: the file is empty; each scan needs a line", path.string())};
}

Result<PosePath> read_poses(const std::filesystem::path& path, LineLimits limits, Sha256& hash) {
    std::vector<StampedPose> samples;
    const auto read = read_lines(path, limits, hash, [&](std::string_view line) -> Result<> {
        const auto sample = read_pose(line);
        if (!sample) return sample.error();
        samples.push_back(*sample);
        return {};
    });
    if (!read) return read.error();
    return PosePath(std::move(samples));
}

} // namespace

Result<SonarLog> SonarLog::open(const std::filesystem::path& measurements, const std::filesystem::path& poses,
                                const SonarOptions& options) {
    Sha256 hash;
    hash.update(fmt::format("sonar 1\n{} {} {}\n", options.range_max, options.aperture,
                            options.no_return == NoReturn::kFree ? "free" : "drop"));
    if (options.poses != Poses::kMap) hash.update(fmt::format("poses {}\n", name_of(options.poses)));
    const auto path = read_poses(poses, options.limits, hash);
    if (!path) return path.error();

    std::vector<Scan> scans;
    const auto read = read_lines(measurements, options.limits, hash, [&](std::string_view line) -> Result<> {
        auto scan = read_measurement(line, options);
        if (!scan) return scan.error();
        const auto pose = path->at(scan->stamp);
        if (!pose) {
            return Error{Errc::kInvalidField,
                         fmt::format("{} has no pose within {:g} s of its time", poses.string(), kPoseGapMax)};
        }
        set_pose(*scan, options.poses, *pose);
        scans.push_back(std::move(*scan));
        return {};
    });
    if (!read) return read.error();
    return SonarLog(make_ring(options), std::move(scans), "sonar:" + hash.hex().substr(0, 32));
}

Result<std::optional<Observation>> SonarLog::next() {
    if (next_ == scans_.size()) return std::optional<Observation>{};
    return std::optional(Observation{ring_, scans_[next_++]});
}

} // namespace scanloom::robot
