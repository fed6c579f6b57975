#include "lab/trajectory_score.hpp"

#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace scanloom::lab {

Result<std::vector<Relation>> read_relations(const std::filesystem::path& path) {
    auto reader = robot::LineReader::open(path);
    if (!reader) return reader.error();
    std::vector<Relation> relations;
    for (;;) {
        const auto line = reader->next();
        if (!line) return line.error();
        if (!*line) break;
        const robot::Tokens tokens = robot::split(**line);
        if (tokens.empty() || tokens.front().starts_with('#')) continue;
        const auto numbers = robot::read_numbers(tokens, 8, "t1 t2 x y z roll pitch yaw");
        if (!numbers) {
            return prefixed(fmt::format("{}:{}: ", path.string(), reader->line_number()), numbers.error());
        }
        const auto& n = *numbers;
        relations.push_back({n[0], n[1], {n[2], n[3], normalize_angle(n[7])}});
    }
    if (!relations.empty()) return relations;
    return Error{Errc::kNotFound,
                 fmt::format("{}: no relation; each line must be: t1 t2 x y z roll pitch yaw", path.string())};
}

namespace {

/// Poses by increasing stamp.
class SortedTrajectory {
public:
    explicit SortedTrajectory(std::vector<robot::StampedPose> poses) : poses_(std::move(poses)) {
        std::ranges::stable_sort(poses_, {}, &robot::StampedPose::stamp);
    }

    /// Returns the interpolated pose; nullopt if the stamp is too far outside the trajectory.
    [[nodiscard]] std::optional<Pose2> at(double stamp) const {
        if (poses_.empty() || stamp < poses_.front().stamp - kStampOutsideMax ||
            stamp > poses_.back().stamp + kStampOutsideMax) {
            return std::nullopt;
        }
        const auto to = std::ranges::lower_bound(poses_, stamp, {}, &robot::StampedPose::stamp);
        if (to == poses_.begin()) return to->robot;
        if (to == poses_.end()) return poses_.back().robot;
        return robot::interpolate(*(to - 1), *to, stamp);
    }

    [[nodiscard]] bool has_scan_at(double stamp) const {
        const auto after = std::ranges::lower_bound(poses_, stamp - kSameStampMax, {}, &robot::StampedPose::stamp);
        return after != poses_.end() && after->stamp <= stamp + kSameStampMax;
    }

private:
    std::vector<robot::StampedPose> poses_;
};

Spread spread_of(std::span<const double> values) {
    if (values.empty()) return {};
    const auto count = static_cast<double>(values.size());
    Spread spread;
    for (const double value : values) spread.mean += value;
    spread.mean /= count;
    double squares = 0.0;
    for (const double value : values) squares += (value - spread.mean) * (value - spread.mean);
    spread.deviation = std::sqrt(squares / std::max(1.0, count - 1.0));
    return spread;
}

ErrorSpread error_spread_of(const std::vector<double>& errors) {
    std::vector<double> squares(errors.size());
    std::ranges::transform(errors, squares.begin(), [](double error) { return error * error; });
    return {spread_of(errors), spread_of(squares)};
}

} // namespace

Result<TrajectoryScore> score_trajectory(std::vector<robot::StampedPose> trajectory,
                                         std::span<const Relation> relations, RelationUse use) {
    const SortedTrajectory poses(std::move(trajectory));
    TrajectoryScore score;
    std::vector<double> translations_m;
    std::vector<double> rotations_deg;
    for (const Relation& relation : relations) {
        const auto from = poses.at(relation.from_stamp);
        const auto to = poses.at(relation.to_stamp);
        if (!from || !to) {
            ++score.missing;
            continue;
        }
        if (use == RelationUse::kOfScans &&
            !(poses.has_scan_at(relation.from_stamp) && poses.has_scan_at(relation.to_stamp))) {
            ++score.left_out;
            continue;
        }
        const Pose2 error = compose(compose(inverse(*from), *to), inverse(relation.T_from_to));
        translations_m.push_back(std::hypot(error.x, error.y));
        rotations_deg.push_back(std::abs(error.yaw) * 180.0 / std::numbers::pi);
    }
    score.used = translations_m.size();
    if (score.used == 0) {
        return Error{
            Errc::kInvalidField,
            fmt::format("no relation of {} can be used: {} are outside the time of the trajectory, {} are of scans "
                        "that were left out; use the relations of this log, or leave out fewer scans",
                        relations.size(), score.missing, score.left_out)};
    }
    score.translation = error_spread_of(translations_m);
    score.rotation = error_spread_of(rotations_deg);
    return score;
}

} // namespace scanloom::lab
