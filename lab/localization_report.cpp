#include "lab/markdown.hpp"
#include "lab/report.hpp"
#include "lab/report_texts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace scanloom::lab {
namespace {

using namespace fmt::literals;

/// A public log, and the mean absolute translation errors that papers state for it. Sources: Kuemmerle et al., 2009;
/// Hess et al., 2016.
struct PublicLog {
    std::string_view name;    ///< of its file
    std::string_view credits; ///< a sentence
    double graph_mapping;     ///< metres
    double cartographer;      ///< metres
};

constexpr PublicLog kPublicLogs[] = {
    {"intel", "Intel Research Lab, Seattle, recorded by D. Haehnel (Radish; SLAM benchmark, CC-BY 3.0).", 0.031,
     0.0229},
    {"fr079", "Freiburg, building 079, recorded by C. Stachniss (SLAM benchmark, CC-BY 3.0).", 0.056, 0.0452},
};

const PublicLog* find_public_log(std::string_view name) {
    const auto* found = std::ranges::find(kPublicLogs, name, &PublicLog::name);
    return found == std::end(kPublicLogs) ? nullptr : found;
}

std::string file_arguments(const std::vector<LogFiles>& files) {
    const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
    std::vector<std::string> names;
    for (const auto& [log, relations] : files) names.push_back(name(log) + " " + name(relations));
    return fmt::format("{}", fmt::join(names, " "));
}

std::string logs_table(const std::vector<LogResult>& logs) {
    Table table("log | scans | duration s | path m | relations");
    for (const LogResult& log : logs) {
        table.add("{} | {} | {:.0f} | {:.0f} | {}", log.name, log.scans, log.seconds, log.path,
                  log.odometry.used + log.odometry.missing);
    }
    return table.text();
}

/// Returns who recorded the public logs among the logs, as sentences after a sentence.
std::string credits(const std::vector<LogResult>& logs) {
    std::string text;
    for (const LogResult& log : logs) {
        if (const auto* known = find_public_log(log.name)) text += fmt::format(" {}: {}", log.name, known->credits);
    }
    return text;
}

std::string accuracy_table(const std::vector<LogResult>& logs) {
    Table table("log | poses | translation m | sd | rotation degrees | sd | unplaced");
    for (const LogResult& log : logs) {
        const auto add = [&](std::string_view poses, const TrajectoryScore& score, std::string_view unplaced) {
            const Spread& translation = score.translation.absolute;
            const Spread& rotation = score.rotation.absolute;
            table.add("{} | {} | {:.4f} | {:.4f} | {:.3f} | {:.3f} | {}", log.name, poses, translation.mean,
                      translation.deviation, rotation.mean, rotation.deviation, unplaced);
        };
        add("raw odometry", log.odometry, "");
        for (const auto& [with, estimate] :
             {std::pair{"with odometry", &log.with_odometry}, {"without odometry", &log.without}}) {
            add(fmt::format("{}, final", with), estimate->final_poses, fmt::format("{}", estimate->unplaced));
            add(fmt::format("{}, first", with), estimate->first_poses, "");
        }
        if (const auto* known = find_public_log(log.name)) {
            table.add("{} | published: graph mapping, 2009 | {} |  |  |  | ", log.name, known->graph_mapping);
            table.add("{} | published: Cartographer, 2016 | {} |  |  |  | ", log.name, known->cartographer);
        }
    }
    return table.text();
}

std::string distance_text(const TrajectoryDistance& distance) {
    return fmt::format("{:.2f} m and {:.1f} degrees", distance.metres, distance.degrees);
}

std::string accuracy_findings(const std::vector<LogResult>& logs) {
    std::vector<std::string> findings;
    for (const LogResult& log : logs) {
        findings.push_back(fmt::format("{}: without odometry, the final poses are at most {} from those with odometry.",
                                       log.name, distance_text(log.without_from_plain)));
    }
    return items(findings);
}

/// Returns the variant with the largest value of a function of it.
template <class Value>
const VariantResult& worst_of(const std::vector<VariantResult>& variants, Value&& value) {
    return *std::ranges::max_element(variants, {}, value);
}

/// Returns one sentence about the variants of a log.
std::string variants_finding(const LogResult& log) {
    const auto& variants = log.variants;
    const auto& inexact = worst_of(variants, &VariantResult::ratio);
    const auto& far = worst_of(variants, [](const auto& variant) { return variant.from_plain.metres; });
    const auto& turned = worst_of(variants, [](const auto& variant) { return variant.from_plain.degrees; });
    const auto loops =
        std::ranges::count_if(variants, [](const auto& variant) { return is_false_loop(variant.from_plain); });
    return fmt::format("{} of {} variants have a false loop; the worst error is {:.2f} times that of the plain "
                       "estimate for the same relations ({}), the largest distance {:.2f} m ({}), the largest turn "
                       "{:.1f} degrees ({}).",
                       loops, variants.size(), inexact.ratio, text_of(inexact.variant), far.from_plain.metres,
                       text_of(far.variant), turned.from_plain.degrees, text_of(turned.variant));
}

std::string variants_table(const LogResult& log) {
    Table table("variant | relations | translation m | ratio | farthest m | degrees | turned scans | false loop");
    const TrajectoryScore& plain = log.with_odometry.final_poses;
    table.add("plain | {} | {:.4f} |  |  |  |  | ", plain.used, plain.translation.absolute.mean);
    for (const auto& [variant, score, ratio, distance] : log.variants) {
        const auto errors =
            score ? fmt::format("{} | {:.4f} | {:.2f}", score->used, score->translation.absolute.mean, ratio)
                  : std::string("0 | - | -");
        table.add("{} | {} | {:.2f} | {:.1f} | {} | {}", text_of(variant), errors, distance.metres, distance.degrees,
                  distance.turned_scans, is_false_loop(distance) ? "yes" : "no");
    }
    return table.text();
}

std::string unknown_starts_table(const std::vector<LogResult>& logs) {
    Table table(
        "log | poses of the second robot | it starts after | located after scans | path m | distance m | degrees");
    for (const LogResult& log : logs) {
        for (const auto& [poses, part, found] : log.unknown_starts) {
            const auto figures = found ? fmt::format("{} | {:.0f} | {:.2f} | {:.1f}", found->scans, found->path,
                                                     found->metres, found->degrees)
                                       : std::string("not located |  |  | ");
            table.add("{} | {} | {:.0f} % | {}", log.name, name_of(poses), 100.0 * part, figures);
        }
    }
    return table.text();
}

std::string maps_table(const LogResult& log) {
    std::vector<std::string> pictures;
    std::vector<std::string> sizes;
    constexpr std::string_view kPoses[] = {"raw odometry", "with odometry", "without odometry"};
    for (std::size_t n = 0; n < log.maps.size(); ++n) {
        const DrawnMap& map = log.maps[n];
        pictures.push_back(picture_cell(map.file, fmt::format("map of {}, {}", log.name, kPoses[n])));
        sizes.push_back(fmt::format("{:.0f} x {:.0f} m, cells of {} m", map.width, map.height, map.cell_size));
    }
    Table table(fmt::format("{}", fmt::join(kPoses, " | ")));
    table.add("{}", fmt::join(pictures, " | "));
    table.add("{}", fmt::join(sizes, " | "));
    return table.text();
}

} // namespace

std::string report_of(const LocalizationResults& results) {
    const auto& logs = results.logs;
    std::vector<std::string> variants;
    std::vector<std::string> maps;
    for (const LogResult& log : logs) {
        variants.push_back(fmt::format("### {}\n\n{}\n\n{}", log.name, variants_finding(log), variants_table(log)));
        maps.push_back(fmt::format("### Map of {}\n\n{}", log.name, maps_table(log)));
    }
    return fmt::format(report_texts::localization, "files"_a = file_arguments(results.files),
                       "logs"_a = logs_table(logs), "credits"_a = credits(logs), "accuracy"_a = accuracy_table(logs),
                       "accuracy_findings"_a = accuracy_findings(logs), "false_loop_m"_a = kFalseLoopMetres,
                       "false_loop_degrees"_a = kFalseLoopDegrees, "turned"_a = kTurned,
                       "variants"_a = fmt::join(variants, "\n\n"), "unknown_starts"_a = unknown_starts_table(logs),
                       "maps"_a = fmt::join(maps, "\n\n"));
}

std::string times_report_of(const LocalizationResults& results, std::string_view machine) {
    Table table("log | poses | scans | CPU s | CPU ms a scan");
    for (const LogResult& log : results.logs) {
        for (const auto& [poses, estimate] :
             {std::pair{"with odometry", &log.with_odometry}, {"without odometry", &log.without}}) {
            table.add("{} | {} | {} | {:.2f} | {:.3f}", log.name, poses, log.scans, estimate->cpu_seconds,
                      1e3 * estimate->cpu_seconds / static_cast<double>(log.scans));
        }
    }
    return fmt::format(report_texts::localization_times, "machine"_a = machine, "times"_a = table.text());
}

} // namespace scanloom::lab
