#include "lab/score_report.hpp"

#include <boost/json/serialize.hpp>
#include <boost/json/string.hpp>
#include <fmt/format.h>

namespace scanloom::lab {
namespace {

double milliseconds_per_scan(const ScoreResult& result) {
    return 1e3 * result.cpu_seconds / static_cast<double>(result.scans);
}

std::string table_row(std::string_view name, const TrajectoryScore& score) {
    const auto cell = [](const Spread& spread, int decimals) {
        return fmt::format("{:.{}f} +- {:.{}f}", spread.mean, decimals, spread.deviation, decimals);
    };
    return fmt::format("{:<12} {:>18} {:>18}", name, cell(score.translation.absolute, 4),
                       cell(score.rotation.absolute, 3));
}

std::string json_of(const ErrorSpread& errors) {
    return fmt::format(R"({{"mean":{:.6f},"std":{:.6f},"squared_mean":{:.6f},"squared_std":{:.6f}}})",
                       errors.absolute.mean, errors.absolute.deviation, errors.squared.mean, errors.squared.deviation);
}

std::string json_of(const TrajectoryScore& score) {
    return fmt::format(R"({{"translation_m":{},"rotation_deg":{}}})", json_of(score.translation),
                       json_of(score.rotation));
}

} // namespace

std::string score_table(const ScoreOptions& options, const ScoreResult& result) {
    const TrajectoryScore& score = result.final_poses;
    return fmt::format("{}: {} scans, poses: {}, {:.2f} s of CPU time, {:.3f} ms per scan\n"
                       "{}: {} relations used, {} outside the trajectory, {} of scans that were left out\n"
                       "{:<12} {:>18} {:>18}\n{}\n{}",
                       options.log, result.scans, name_of(options.poses), result.cpu_seconds,
                       milliseconds_per_scan(result), options.relations, score.used, score.missing, score.left_out, "",
                       "translation, m", "rotation, deg", table_row("final poses", score),
                       table_row("first poses", result.first_poses));
}

std::string score_json(const ScoreOptions& options, const ScoreResult& result) {
    const TrajectoryScore& score = result.final_poses;
    const Perturbation& perturbation = options.perturbation;
    return fmt::format(R"({{"log":{},"poses":"{}","odometry_scale":{},"every":{},"skip":{},"scans":{},)"
                       R"("skipped_lines":{},"cpu_seconds":{:.3f},"ms_per_scan":{:.4f},)"
                       R"("relations":{{"used":{},"missing":{},"left_out":{}}},"final":{},"first":{}}})",
                       boost::json::serialize(boost::json::string(options.log)), name_of(options.poses),
                       perturbation.odometry_scale, perturbation.every, perturbation.skip, result.scans,
                       result.skipped_lines, result.cpu_seconds, milliseconds_per_scan(result), score.used,
                       score.missing, score.left_out, json_of(score), json_of(result.first_poses));
}

} // namespace scanloom::lab
