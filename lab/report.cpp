#include "lab/report.hpp"

#include <fmt/format.h>

#include <functional>

namespace scanloom::lab {
namespace {

using Chosen = std::vector<const RunResult*>;
using Choose = std::function<bool(const RunSpec&)>;

Chosen chosen_from(const std::vector<RunResult>& results, const Choose& choose) {
    Chosen chosen;
    for (const RunResult& result : results) {
        if (choose(result.spec)) chosen.push_back(&result);
    }
    return chosen;
}

double mean_of(const Chosen& chosen, const std::function<double(const RunResult&)>& value) {
    double sum = 0.0;
    for (const RunResult* result : chosen) sum += value(*result);
    return chosen.empty() ? 0.0 : sum / static_cast<double>(chosen.size());
}

std::string share(double value) { return fmt::format("{:.3f}", value); }
std::string metres(double value) { return fmt::format("{} m", value); }

const std::vector<std::string> kScoreHead{"precision", "recall",  "IoU",      "exact IoU", "free recall",
                                          "person",    "residue", "occupied", "touched"};

std::vector<std::string> score_cells(const Chosen& chosen) {
    const auto mean = [&](auto member) {
        return mean_of(chosen, [&](const RunResult& result) { return static_cast<double>(result.scores.*member); });
    };
    return {
        share(mean(&Scores::precision)),
        share(mean(&Scores::recall)),
        share(mean(&Scores::iou)),
        share(mean(&Scores::iou_exact)),
        share(mean(&Scores::free_recall)),
        fmt::format("{:.0f}", mean_of(chosen, [](const RunResult& r) { return static_cast<double>(r.of_walkers); })),
        fmt::format("{:.0f}", mean(&Scores::residue)),
        fmt::format("{:.0f}", mean(&Scores::occupied)),
        fmt::format("{:.0f}", mean_of(chosen, [](const RunResult& r) { return static_cast<double>(r.touched); }))};
}

Items conditions(const Matrix& matrix) {
    return {{
        ("Scenes: static, a furnished room of 10 x 10 m; dynamic, the same with a person (a disc of 0.5 m) who walks "
         "around its furniture at 1 m/s. The ground truth is the room without the person."),
        fmt::format("Each run: {} scans, ten a second, of the reference laser (684 beams over 180 degrees, 5 m), on "
                    "the trajectory of the wall follower from one of {} starts. Poses are exact, and the trajectory is "
                    "the same in every run from a start.",
                    matrix.scans, matrix.starts.size()),
        fmt::format("The room's centre is at ({}, {}) m, so that no wall is on the border between two cells.",
                    kRoomMiddle.x, kRoomMiddle.y),
        ("Noise: none; gaussian, ranges with sigma 0.02 m and beam angles with sigma 0.005 rad, beams without a return "
         "left out (otherwise they are free up to 5 m); 1_cell and 3_cells, each reading too long by 0 to one or three "
         "cells, uniformly distributed."),
        fmt::format(
            "All settings of the maps are defaults, except the cell size and the ray model. Seed of the noise: {}.",
            matrix.seed),
    }};
}

Items definitions() {
    return {{
        ("A cell of the map is occupied from p = 0.65 on and free up to 0.35. A cell of the ground truth is solid if "
         "any part of it contains a solid."),
        ("Visible: a free cell whose centre, or a solid cell with a point of its surface, was in the line of sight of "
         "one of the run's poses, in the laser's range and field of view. Other cells are not required."),
        "Tolerance: one cell (the eight around a cell count as itself), but for exact IoU, which has none.",
        ("precision: the share of the map's occupied cells that are at a solid. recall: the share of visible solid "
         "cells with an occupied cell in the map. IoU: the Jaccard index of precision P and recall R, P R / (P + R - P "
         "R)."),
        ("exact IoU: visible solid cells that are occupied in the map, as a share of all visible solid cells and all "
         "occupied cells of the map that are not solid. Invisible cells inside solids do not count."),
        "free recall: the share of visible free cells without a solid neighbour that are free in the map.",
        ("person: readings of the run that hit the person. residue: occupied cells away from every solid where the "
         "person was during the run but not at its end: cells that were not cleared. Cells of the person's final "
         "position count against precision, if the last scans observed it."),
        "occupied: the map's occupied cells. touched: cells that any scan changed.",
        ("The inverse sensor model marks a band of 0.1 m, half of it before the surface. At 1 cm that half is five "
         "cells, more than the tolerance, and reduces precision and free recall; all five reduce exact IoU, in which a "
         "surface is one cell."),
    }};
}

Table summary(const Matrix& matrix, const std::vector<RunResult>& results) {
    Table table{joined({"scene", "cell", "ray model"}, kScoreHead), {}};
    for (const Scene& scene : matrix.scenes) {
        for (const double cell_size : matrix.cell_sizes) {
            for (const RayModelChoice& model : matrix.ray_models) {
                const auto chosen = chosen_from(results, [&](const RunSpec& spec) {
                    return spec.scene.name == scene.name && spec.cell_size == cell_size &&
                           spec.ray_model.name == model.name && spec.noise.name == "none";
                });
                table.rows.push_back(
                    joined({std::string(scene.name), metres(cell_size), std::string(model.name)}, score_cells(chosen)));
            }
        }
    }
    return table;
}

Table every_run(const Chosen& chosen) {
    Table table{joined({"ray model", "noise", "start"}, kScoreHead), {}};
    for (const RunResult* result : chosen) {
        const RunSpec& spec = result->spec;
        table.rows.push_back(
            joined({std::string(spec.ray_model.name), std::string(spec.noise.name), std::string(spec.start.name)},
                   score_cells({result})));
    }
    return table;
}

std::string caption_of(const RunSpec& spec) {
    return fmt::format("{}, cells of {} m, {}, noise: {}; after 10, 25, 50 and 100 % of the run", spec.scene.name,
                       spec.cell_size, spec.ray_model.name, spec.noise.name);
}

void add_runs(Document& document, const Matrix& matrix, const std::vector<RunResult>& results) {
    for (const Scene& scene : matrix.scenes) {
        for (const double cell_size : matrix.cell_sizes) {
            const auto chosen = chosen_from(results, [&](const RunSpec& spec) {
                return spec.scene.name == scene.name && spec.cell_size == cell_size;
            });
            document.push_back(Heading{3, fmt::format("{}, cells of {} m", scene.name, cell_size)});
            document.push_back(every_run(chosen));
            for (const RunResult* result : chosen) {
                if (result->picture.empty()) continue;
                document.push_back(
                    Picture{fmt::format("{}/{}", kPicturesFolder, result->picture), caption_of(result->spec)});
            }
        }
    }
}

std::string milliseconds(double value) { return fmt::format("{:.3f}", value); }

/// Returns the published duration of the reference experiments, in their slower language; empty if none is published.
std::string published(double cell_size) {
    if (cell_size == 0.01) return "80";
    if (cell_size == 0.1) return "8";
    if (cell_size == 0.5) return "1";
    return "";
}

} // namespace

Document report_of(const Matrix& matrix, const std::vector<RunResult>& results) {
    Document document{
        Heading{1, "The reference experiments"},
        Paragraph{"The quality of the maps, measured with exact ground truth: two scenes, several cell sizes, ray "
                  "models and kinds of noise, from two starts. Made by"},
        Code{"./scanloom build && build/bin/scanloom-lab experiment --out docs/experiment"},
        Paragraph{
            "The same seed gives the same bytes. The durations are in a separate file, because they differ each time:"},
        Link{"Times", kTimesFile},
        Heading{2, "Conditions"},
        conditions(matrix),
        Heading{2, "What is compared"},
        definitions(),
        Heading{2, "Without noise"},
        Paragraph{"Means over the starts."},
        summary(matrix, results),
        Heading{2, "Every run"},
        Paragraph{"In the pictures white is free, black occupied, grey unknown; blue is the robot and its trajectory, "
                  "red are the points of the newest scan, orange is the person."},
    };
    add_runs(document, matrix, results);
    return document;
}

Document times_report_of(const Matrix& matrix, const std::vector<RunResult>& results, std::string_view machine) {
    Table means{{"cell", "ray model", "mean ms", "median ms", "95 % below, ms", "published, ms"}, {}};
    for (const double cell_size : matrix.cell_sizes) {
        for (const RayModelChoice& model : matrix.ray_models) {
            const auto chosen = chosen_from(results, [&](const RunSpec& spec) {
                return spec.cell_size == cell_size && spec.ray_model.name == model.name && spec.noise.name == "none";
            });
            const auto mean = [&](auto member) {
                return milliseconds(mean_of(chosen, [&](const RunResult& result) { return result.times.*member; }));
            };
            means.rows.push_back({metres(cell_size), std::string(model.name), mean(&ScanTimes::mean),
                                  mean(&ScanTimes::median), mean(&ScanTimes::percentile_95), published(cell_size)});
        }
    }
    Table runs{{"run", "mean ms", "median ms", "95 % below, ms"}, {}};
    for (const RunResult& result : results) {
        runs.rows.push_back({name_of(result.spec), milliseconds(result.times.mean), milliseconds(result.times.median),
                             milliseconds(result.times.percentile_95)});
    }
    return {
        Heading{1, "Times of the reference experiments"},
        Paragraph{fmt::format(
            "Milliseconds for integrating one scan of 684 beams into all maps of a session (log-odds, HIMM and "
            "classes), with a snapshot after every {} scans, which updates frontiers and danger and makes the next "
            "scan copy the cells that it changes. One thread. Figures of several runs are averaged. Measured on: {}.",
            kScansPerSnapshot, machine)},
        Paragraph{"Published: the time for a scan in the report of the original experiments, in an interpreted "
                  "language on another machine, also for a room of 10 x 10 m."},
        Link{"The report", kReportFile},
        Heading{2, "Means over scenes and starts, without noise"},
        std::move(means),
        Heading{2, "Every run"},
        std::move(runs),
    };
}

} // namespace scanloom::lab
