#include "lab/experiment.hpp"

#include "lab/map_cells.hpp"
#include "lab/pictures.hpp"
#include "lab/scoring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace scanloom::lab {
namespace {

/// Returns the box of the ground truth with a margin, so that walls that maps place outside the room are found, also at
/// 0.5 m.
grid::CellBox box_of(const sim::GroundTruthGrid& truth) {
    const auto margin = static_cast<std::int32_t>(std::ceil(2.0 / truth.cell_size));
    return {truth.i_begin - margin, truth.j_begin - margin, truth.i_begin + truth.width + margin,
            truth.j_begin + truth.height + margin};
}

/// Marks the cells that a walker covered or that scans of it may mark: within half the thickness of obstacles plus the
/// tolerance of the scores.
void mark_discs(const std::vector<sim::Disc>& discs, double reach, double cell_size, std::uint8_t value,
                CellMask& mask) {
    for (const sim::Disc& disc : discs) {
        const double radius = disc.radius + reach;
        const auto first = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres / cell_size)); };
        for (std::int32_t j = first(disc.centre.y - radius); j <= first(disc.centre.y + radius); ++j) {
            for (std::int32_t i = first(disc.centre.x - radius); i <= first(disc.centre.x + radius); ++i) {
                const Point2 centre{(i + 0.5) * cell_size, (j + 0.5) * cell_size};
                if (mask.contains({i, j}) && norm(centre - disc.centre) <= radius) mask.at({i, j}) = value;
            }
        }
    }
}

} // namespace

Standard make_standard(const std::vector<Pose2>& path, double cell_size_m) {
    const sim::World world = world_of("room");
    const sim::GroundTruthGrid grid = sim::ground_truth_of(world, cell_size_m);
    Standard standard{GroundTruthCells(box_of(grid), sim::GroundTruth::kOutside), {}};
    for_each_cell(standard.truth.box, [&](grid::Cell cell) { standard.truth.at(cell) = grid.at(cell.i, cell.j); });
    standard.seen = visible_cells(world, grid, reference_laser(), path, standard.truth.box);
    return standard;
}

CellMask walked_cells(const Recording& recording, const mapping::MapConfig& config, const grid::CellBox& box) {
    const double cell_size = config.cell_size;
    const double reach = std::max(config.obstacle_thickness, cell_size) / 2.0 + kTolerance * cell_size;
    CellMask walked(box, 0);
    for (const auto& discs : recording.walkers) mark_discs(discs, reach, cell_size, 1, walked);
    mark_discs(recording.walkers.back(), reach, cell_size, 0, walked);
    return walked;
}

namespace {

constexpr double kPicturedNoiseCell = 0.05; // metres

/// The extent of pictures: the room, 10 x 10 m, and a margin.
tiles::Extent pictured_part() {
    constexpr double kHalf = 5.3;
    return {kRoomMiddle.x - kHalf, kRoomMiddle.y - kHalf, kRoomMiddle.x + kHalf, kRoomMiddle.y + kHalf};
}

ScanTimes times_of(std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    const auto at = [&](double share) {
        return 1e3 * seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
    };
    const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    return {1e3 * sum / static_cast<double>(seconds.size()), at(0.5), at(0.95)};
}

/// Performs the runs of a matrix one after the other.
class Runner {
public:
    Runner(const Matrix& matrix, const Surroundings& surroundings) : matrix_(matrix), surroundings_(surroundings) {}

    [[nodiscard]] Result<std::vector<RunResult>> run_all();

private:
    [[nodiscard]] Result<> run_from(const Start& start);
    [[nodiscard]] Result<> run(const RunSpec& spec, const Recording& recording, const Standard& standard);

    const Matrix& matrix_;
    const Surroundings& surroundings_;
    std::vector<RunResult> results_;
    std::size_t scans_ = 0;
};

Result<std::vector<RunResult>> Runner::run_all() {
    for (const Start& start : matrix_.starts) {
        if (auto ok = run_from(start); !ok) return ok.error();
    }
    return std::move(results_);
}

Result<> Runner::run_from(const Start& start) {
    const auto path = drive_from(start, matrix_.scans);
    for (const double cell_size : matrix_.cell_sizes) {
        const Standard standard = make_standard(path, cell_size);
        for (const Scene& scene : matrix_.scenes) {
            for (const NoiseChoice& noise : matrix_.noises) {
                const Recording recording = record(scene, path, noise, cell_size, matrix_.seed);
                for (const RayModelChoice& ray_model : matrix_.ray_models) {
                    const RunSpec spec{scene, cell_size, ray_model, noise, start};
                    if (auto ok = run(spec, recording, standard); !ok) return ok.error();
                }
            }
        }
    }
    return {};
}

Result<> Runner::run(const RunSpec& spec, const Recording& recording, const Standard& standard) {
    SessionOptions options;
    options.cell_size = spec.cell_size;
    spec.ray_model.choose(options);
    const auto wanted = is_pictured(matrix_, spec) ? std::span(kMoments) : std::span(kMoments).last(1);
    std::vector<Moment> moments;
    const auto after_scan = [&](std::size_t scans, mapping::Projection& projection) {
        surroundings_.on_scan(spec, results_.size(), ++scans_);
        if (static_cast<double>(scans) < wanted[moments.size()] * static_cast<double>(recording.scans.size())) return;
        moments.push_back({projection.snapshot(), scans});
    };
    auto seconds = integrate_recording(recording, options, surroundings_.now, after_scan);
    if (!seconds) return seconds.error();

    RunResult result{spec, {}, 0, 0, "", times_of(std::move(*seconds))};
    const mapping::Snapshot& end = moments.back().snapshot;
    const LogOddsGrid map = occupancy_of(end, standard.truth.box);
    result.scores =
        score(states_of(map), standard.truth, standard.seen, walked_cells(recording, end.config, standard.truth.box));
    result.touched = touched_cells(map);
    result.of_walkers = recording.of_walkers;
    if (moments.size() == kMoments.size()) {
        result.picture = name_of(spec) + ".png";
        if (auto kept = surroundings_.keep_picture(result.picture, strip_png(moments, recording, pictured_part()));
            !kept) {
            return kept.error();
        }
    }
    results_.push_back(std::move(result));
    return {};
}

} // namespace

std::string name_of(const RunSpec& spec) {
    return fmt::format("{}_{}_{}_{}_{}", spec.scene.name, spec.cell_size, spec.ray_model.name, spec.noise.name,
                       spec.start.name);
}

bool is_pictured(const Matrix& matrix, const RunSpec& spec) {
    return spec.start.name == matrix.starts.front().name &&
           (spec.noise.name == "none" || spec.cell_size == kPicturedNoiseCell);
}

Result<std::vector<RunResult>> run_experiment(const Matrix& matrix, const Surroundings& surroundings) {
    return Runner(matrix, surroundings).run_all();
}

} // namespace scanloom::lab
