#include "lab/report.hpp"

#include "lab/landmark_findings.hpp"
#include "lab/markdown.hpp"
#include "lab/report_texts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace scanloom::lab {
namespace {

using namespace fmt::literals;

std::string share(std::optional<double> value) { return value ? fmt::format("{:.2f}", *value) : "-"; }
std::string metres(std::optional<double> value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

constexpr const char* kComparisonHead =
    "matched | only first | only second | persistence | stability | mean m | sd m | "
    "linearity | evenness | fill | continuity";

/// Returns the cells of kComparisonHead.
std::string comparison_cells(const Comparison& comparison) {
    const auto& [matched, persistence, stability, mean, sigma] = comparison.metrics;
    const auto& continuity = comparison.continuity;
    return fmt::format("{} | {} | {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f}", matched,
                       comparison.only_first, comparison.only_second, share(persistence), share(stability),
                       metres(mean), metres(sigma), continuity.linearity, continuity.evenness, continuity.fill,
                       continuity.mean());
}

std::string door_table(const LandmarkResults& results) {
    Table table(fmt::format("place | door | {}", kComparisonHead));
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        table.add("{} | opened | {}", n + 1, comparison_cells(results.places[n].door.comparison));
        table.add("{} | closed in both | {}", n + 1, comparison_cells(results.places[n].control));
    }
    table.add("published |  |  |  |  | {} | {} |  |  |  |  |  | {}", range_text(kPublishedPersistence),
              range_text(kPublishedStability), range_text(kPublishedContinuity));
    return table.text();
}

std::string neighbour_table(const LandmarkResults& results) {
    Table table(fmt::format("places | door | {}", kComparisonHead));
    for (const auto& [from, to, door_moved, comparison] : results.neighbours) {
        table.add("{} to {} | {} | {}", from + 1, to + 1, door_moved ? "opened" : "closed in both",
                  comparison_cells(comparison));
    }
    return table.text();
}

std::string tolerance_table(const LandmarkResults& results) {
    Table table("tolerance m | matched | persistence | stability | mean m | sd m");
    for (const auto& [tolerance, metrics] : results.tolerances) {
        table.add("{:.1f} | {} | {} | {} | {} | {}", tolerance, metrics.matched, share(metrics.persistence),
                  share(metrics.stability), metres(metrics.distance_mean), metres(metrics.distance_sigma));
    }
    table.add("published, {:.1f} |  |  |  | {:.3f} | {:.3f}", kPublishedTolerance, kPublishedDistanceMean,
              kPublishedDistanceSigma);
    return table.text();
}

std::string readings_table(const LandmarkResults& results) {
    Table table("readings | points | eps m | landmarks | robot's bytes | server's bytes");
    for (const ReadingsRow& row : results.readings) {
        table.add("{} | {} | {:.3f} | {} | {} | {}", row.readings, row.points, row.eps, row.landmarks, row.robot_bytes,
                  row.server_bytes);
    }
    return table.text();
}

std::string window_table(const LandmarkResults& results) {
    Table table("window | RMSE m | noise reduction x | noise reduction y | error on walls m | at corners m");
    for (const auto& [window, figures, wall_error, corner_error] : results.windows) {
        table.add("{} | {:.3f} | {} | {} | {:.3f} | {:.3f}", window, figures.rmse, share(figures.noise_reduction_x),
                  share(figures.noise_reduction_y), wall_error, corner_error);
    }
    return table.text();
}

std::string recording_part(const RecordedResult& recorded) {
    const auto& [name, remarks, turns, all, halves] = recorded;
    Table parts("part | turns | points | eps m | landmarks");
    const auto add = [&](std::string_view part, std::size_t count, const SeenLandmarks& seen) {
        parts.add("{} | {} | {} | {:.3f} | {}", part, count, seen.points.size(), seen.survey.eps,
                  seen.survey.landmarks.size());
    };
    add("whole", turns, all);
    add("first half", turns / 2, halves.first);
    add("second half", turns - turns / 2, halves.second);
    Table comparison(kComparisonHead);
    comparison.add("{}", comparison_cells(halves.comparison));
    return fmt::format(
        report_texts::landmark_recording, "name"_a = name, "remarks"_a = remarks, "parts"_a = parts.text(),
        "halves"_a = comparison.text(), "finding"_a = recording_finding(recorded),
        "picture"_a =
            picture(halves.picture, fmt::format("first and second half of {}, recorded from a real LD06", name)));
}

} // namespace

std::string report_of(const LandmarkResults& results) {
    std::vector<std::string> places;
    std::vector<std::string> pictures;
    for (const auto& [place, door, control] : results.places) {
        const std::size_t number = places.size() + 1;
        places.push_back(fmt::format("{} at ({}, {})", number, place.x, place.y));
        pictures.push_back(picture(door.picture, fmt::format("place {}: door closed, door open", number)));
    }
    const sim::Noise noise;
    auto report =
        fmt::format(report_texts::landmarks, "seed"_a = results.seed,
                    "capture"_a = results.recorded ? " --capture " + results.recorded->name : "",
                    "places"_a = fmt::join(places, ", "), "turns"_a = kTurns, "range_noise"_a = noise.range,
                    "angle_noise"_a = noise.beam_angle, "doors"_a = door_table(results),
                    "door_findings"_a = items(door_findings(results)), "pictures"_a = fmt::join(pictures, "\n\n"),
                    "neighbours"_a = neighbour_table(results), "tolerances"_a = tolerance_table(results),
                    "tolerance_finding"_a = tolerance_finding(results), "readings"_a = readings_table(results),
                    "windows"_a = window_table(results), "window_finding"_a = window_finding(results.windows));
    if (results.recorded) report += "\n" + recording_part(*results.recorded);
    return report;
}

std::string times_report_of(const LandmarkResults& results, std::string_view machine) {
    Table readings("readings | points | median ms | ns a point");
    for (const ReadingsRow& row : results.readings) {
        readings.add("{} | {} | {:.2f} | {:.0f}", row.readings, row.points, row.milliseconds,
                     1e6 * row.milliseconds / static_cast<double>(row.points));
    }
    return fmt::format(report_texts::landmark_times, "timings"_a = kTimings, "machine"_a = machine,
                       "readings"_a = readings.text());
}

} // namespace scanloom::lab
