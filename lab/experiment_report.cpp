#include "lab/report.hpp"

#include "lab/markdown.hpp"
#include "lab/report_texts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace scanloom::lab {
namespace {

using namespace fmt::literals;

using Chosen = std::vector<const RunResult*>;

template <class Choose>
Chosen chosen_from(const std::vector<RunResult>& results, Choose&& choose) {
    Chosen chosen;
    for (const RunResult& result : results) {
        if (choose(result.spec)) chosen.push_back(&result);
    }
    return chosen;
}

template <class ValueOf>
double mean_of(const Chosen& chosen, ValueOf&& value_of) {
    double sum = 0.0;
    for (const RunResult* result : chosen) sum += static_cast<double>(value_of(*result));
    return chosen.empty() ? 0.0 : sum / static_cast<double>(chosen.size());
}

constexpr const char* kScoreHead =
    "precision | recall | IoU | exact IoU | free recall | person | residue | occupied | touched";

/// Returns the cells of kScoreHead: means over some runs.
std::string score_cells(const Chosen& chosen) {
    const auto mean = [&](auto member) {
        return mean_of(chosen, [&](const RunResult& result) { return result.scores.*member; });
    };
    return fmt::format(
        "{:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.0f} | {:.0f} | {:.0f} | {:.0f}", mean(&Scores::precision),
        mean(&Scores::recall), mean(&Scores::iou), mean(&Scores::iou_exact), mean(&Scores::free_recall),
        mean_of(chosen, [](const RunResult& result) { return result.of_walkers; }), mean(&Scores::residue),
        mean(&Scores::occupied), mean_of(chosen, [](const RunResult& result) { return result.touched; }));
}

std::string summary(const Matrix& matrix, const std::vector<RunResult>& results) {
    Table table(fmt::format("scene | cell | ray model | {}", kScoreHead));
    for (const Scene& scene : matrix.scenes) {
        for (const double cell_size : matrix.cell_sizes) {
            for (const RayModelChoice& model : matrix.ray_models) {
                const auto chosen = chosen_from(results, [&](const RunSpec& spec) {
                    return spec.scene.name == scene.name && spec.cell_size == cell_size &&
                           spec.ray_model.name == model.name && spec.noise.name == "none";
                });
                table.add("{} | {} m | {} | {}", scene.name, cell_size, model.name, score_cells(chosen));
            }
        }
    }
    return table.text();
}

/// Returns a table and the pictures of some runs, below a heading.
std::string runs_of(const Scene& scene, double cell_size, const Chosen& chosen) {
    Table table(fmt::format("ray model | noise | start | {}", kScoreHead));
    std::string pictures;
    for (const RunResult* result : chosen) {
        const RunSpec& spec = result->spec;
        table.add("{} | {} | {} | {}", spec.ray_model.name, spec.noise.name, spec.start.name, score_cells({result}));
        if (result->picture.empty()) continue;
        pictures += "\n\n" + picture(result->picture,
                                     fmt::format("{}, cells of {} m, {}, noise: {}; after 10, 25, 50 and 100 % of the "
                                                 "run",
                                                 scene.name, cell_size, spec.ray_model.name, spec.noise.name));
    }
    return fmt::format("### {}, cells of {} m\n\n{}{}", scene.name, cell_size, table.text(), pictures);
}

/// Returns the published duration of the reference experiments, in their slower language; empty if none is published.
const char* published(double cell_size) {
    if (cell_size == 0.01) return "80";
    if (cell_size == 0.1) return "8";
    if (cell_size == 0.5) return "1";
    return "";
}

} // namespace

std::string report_of(const Matrix& matrix, const std::vector<RunResult>& results) {
    std::vector<std::string> runs;
    for (const Scene& scene : matrix.scenes) {
        for (const double cell_size : matrix.cell_sizes) {
            runs.push_back(runs_of(scene, cell_size, chosen_from(results, [&](const RunSpec& spec) {
                                       return spec.scene.name == scene.name && spec.cell_size == cell_size;
                                   })));
        }
    }
    return fmt::format(report_texts::experiment, "scans"_a = matrix.scans, "starts"_a = matrix.starts.size(),
                       "x"_a = kRoomMiddle.x, "y"_a = kRoomMiddle.y, "seed"_a = matrix.seed,
                       "summary"_a = summary(matrix, results), "runs"_a = fmt::join(runs, "\n\n"));
}

std::string times_report_of(const Matrix& matrix, const std::vector<RunResult>& results, std::string_view machine) {
    Table means("cell | ray model | mean ms | median ms | 95 % below, ms | published, ms");
    for (const double cell_size : matrix.cell_sizes) {
        for (const RayModelChoice& model : matrix.ray_models) {
            const auto chosen = chosen_from(results, [&](const RunSpec& spec) {
                return spec.cell_size == cell_size && spec.ray_model.name == model.name && spec.noise.name == "none";
            });
            const auto mean = [&](auto member) {
                return mean_of(chosen, [&](const RunResult& result) { return result.times.*member; });
            };
            means.add("{} m | {} | {:.3f} | {:.3f} | {:.3f} | {}", cell_size, model.name, mean(&ScanTimes::mean),
                      mean(&ScanTimes::median), mean(&ScanTimes::percentile_95), published(cell_size));
        }
    }
    Table runs("run | mean ms | median ms | 95 % below, ms");
    for (const auto& [spec, scores, touched, of_walkers, picture, times] : results) {
        runs.add("{} | {:.3f} | {:.3f} | {:.3f}", name_of(spec), times.mean, times.median, times.percentile_95);
    }
    return fmt::format(report_texts::experiment_times, "scans"_a = kScansPerSnapshot, "machine"_a = machine,
                       "means"_a = means.text(), "runs"_a = runs.text());
}

} // namespace scanloom::lab
