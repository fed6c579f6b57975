#include "core/mapping/laser_layers.hpp"

#include "core/mapping/chunk_kernels.hpp"
#include "core/mapping/map_patch_cells.hpp"
#include "core/mapping/reach.hpp"
#include "core/mapping/sweep/sweep.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace scanloom::mapping {
namespace {

const std::shared_ptr<const LaserChunk>& blank_laser_chunk() {
    static const auto blank = [] {
        LaserChunk chunk;
        chunk.occupancy.fill(kUnknownLogOdds);
        chunk.himm.fill(kUnseenHimm);
        return std::make_shared<const LaserChunk>(chunk);
    }();
    return blank;
}

/// Thresholds are rounded in the same way as evidence, so that evidence or a clamp of exactly a threshold's probability
/// reaches the threshold.
classify::Hysteresis<LogOdds> hysteresis_of_occupancy(const MapConfig& config) {
    const auto fixed = [](double p) {
        return static_cast<LogOdds>(std::lround(std::clamp(log_odds_of(p) * kLogOddsScale, -32766.0, 32767.0)));
    };
    const LogOdds occupied = fixed(config.class_p_occupied);
    const LogOdds free = std::min(fixed(config.class_p_free), static_cast<LogOdds>(occupied - 1));
    return {occupied, free, free, kUnknownLogOdds};
}

/// An unexplored cell becomes free when its counter reaches 0. class_himm_free is no suitable limit for it, because the
/// counter after a first hit may be below it.
classify::Hysteresis<HimmCount> hysteresis_of_himm(const MapConfig& config) {
    return {static_cast<HimmCount>(config.class_himm_occupied), static_cast<HimmCount>(config.class_himm_free), 0,
            kUnseenHimm};
}

bool is_swept(const MapConfig& config) { return config.ray_model == RayModel::kInverseSensorModel; }

constexpr grid::BitPlane all_cells() {
    grid::BitPlane plane{};
    plane.fill(~std::uint64_t{0});
    return plane;
}

grid::BitPlane touched_by(const ChunkVerdicts& verdicts) {
    grid::BitPlane touched;
    for (std::size_t j = 0; j < touched.size(); ++j) touched[j] = verdicts.free[j] | verdicts.occupied[j];
    return touched;
}

/// Extends a box to contain the cells of a chunk that have a verdict.
void include(grid::CellBox& box, grid::ChunkKey key, const ChunkVerdicts& verdicts) {
    const std::int32_t left = key.ci * grid::kChunkSide;
    const std::int32_t bottom = key.cj * grid::kChunkSide;
    const bool is_inside = box.i_begin <= left && left + grid::kChunkSide <= box.i_end && box.j_begin <= bottom &&
                           bottom + grid::kChunkSide <= box.j_end;
    if (is_inside) return;
    const grid::BitPlane touched = touched_by(verdicts);
    const std::uint64_t columns = std::accumulate(touched.begin(), touched.end(), std::uint64_t{0}, std::bit_or<>());
    if (columns == 0) return;
    const auto is_touched = [](std::uint64_t row) { return row != 0; };
    const auto first = std::find_if(touched.begin(), touched.end(), is_touched) - touched.begin();
    const auto end = touched.rend() - std::find_if(touched.rbegin(), touched.rend(), is_touched);
    box.include({left + std::countr_zero(columns), bottom + static_cast<std::int32_t>(first),
                 left + grid::kChunkSide - std::countl_zero(columns), bottom + static_cast<std::int32_t>(end)});
}

} // namespace

LaserFan make_laser_fan(const MapConfig& config, const BeamAngles& angles, double aperture) {
    const double for_occupancy = aperture > 0.0 ? aperture : config.beam_aperture;
    const double for_himm = aperture > 0.0 ? aperture : config.himm_beam_aperture;
    LaserFan fan;
    const auto ring_of = [&](double width) {
        return std::make_shared<const FanRing>(make_fan_ring(make_beam_fan(angles, width)));
    };
    fan.himm = ring_of(for_himm);
    if (config.ray_model == RayModel::kInverseSensorModel) {
        const bool alike = for_occupancy == for_himm;
        fan.occupancy = alike ? fan.himm : ring_of(for_occupancy);
        return fan;
    }
    fan.beams.reserve(beam_count(angles));
    for (std::size_t beam = 0; beam < beam_count(angles); ++beam) {
        const double angle = beam_angle(angles, beam);
        fan.beams.push_back({std::cos(angle), std::sin(angle)});
    }
    return fan;
}

LaserLayers::LaserLayers(const MapConfig& config) : LaserLayers(config, ChunkGrid<LaserChunk>(blank_laser_chunk())) {}

LaserLayers::LaserLayers(const MapConfig& config, ChunkGrid<LaserChunk> grid)
    : config_(config), occupancy_(config), himm_(config), by_occupancy_(hysteresis_of_occupancy(config)),
      by_himm_(hysteresis_of_himm(config)), grid_(std::move(grid)), stage_(first_stage(config)) {}

/// The inverse sensor model adds evidence in the sweep; the other models trace beams before it.
LaserLayers::Stage LaserLayers::first_stage(const MapConfig& config) {
    return is_swept(config) ? Stage::kSweep : Stage::kBeams;
}

bool LaserLayers::integrate(const LaserScan& scan, Revision revision, double& work) {
    grid_.begin(revision);
    if (stage_ == Stage::kBeams) {
        if (!trace_beams(scan, work)) return false;
        stage_ = Stage::kMarks;
    }
    if (stage_ == Stage::kMarks) {
        if (!add_marks(work)) return false;
        stage_ = Stage::kSweep;
        done_ = 0;
    }
    if (stage_ == Stage::kSweep) {
        if (!sweep(scan, work)) return false;
        stage_ = Stage::kClasses;
        done_ = 0;
        changed_ = grid_.changed_in(touched_);
    }
    if (!update_classes(work)) return false;
    stage_ = first_stage(config_);
    done_ = 0;
    touched_ = {};
    return true;
}

void LaserLayers::replace_with(LaserLayers other, Revision revision) {
    grid_.begin(revision);
    grid_.replace_with(other.grid_, [](const LaserChunk& a, const LaserChunk& b) {
        return a.occupancy == b.occupancy && a.himm == b.himm && a.occ_types.free == b.occ_types.free &&
               a.occ_types.occupied == b.occ_types.occupied;
    });
    bounds_ = other.bounds_;
}

void LaserLayers::import(const MapPatch& patch, Revision revision) {
    grid_.begin(revision);
    for_each_cell_of(patch, config_.cell_size, [&](grid::Cell cell, MapCell to) { set(cell, to); });
    double unbounded = HUGE_VAL;
    changed_ = grid_.changed_in(touched_);
    static_cast<void>(update_classes(unbounded));
    done_ = 0;
    touched_ = {};
}

void LaserLayers::set(grid::Cell cell, MapCell to) {
    if (to == MapCell::kUnknown) return;
    const bool is_occupied = to == MapCell::kOccupied;
    bounds_.occupancy.include_row(cell.j, cell.i, cell.i + 1);
    bounds_.himm.include_row(cell.j, cell.i, cell.i + 1);
    touched_.include_row(cell.j, cell.i, cell.i + 1);
    grid_.write_row(cell.j, cell.i, cell.i + 1, [&](LaserChunk& chunk, std::int32_t i, std::size_t) {
        const auto at = grid::index_in_chunk({i, cell.j});
        if (!is_occupied && chunk.occupancy[at] != kUnknownLogOdds) return;
        chunk.occupancy[at] = is_occupied ? occupancy_.l_max : occupancy_.l_min;
        chunk.himm[at] = is_occupied ? kHimmMax : 0;
    });
}

/// Models that trace rays mark cells first, because a hit takes precedence over all passes of a scan, or of a beam.
bool LaserLayers::trace_beams(const LaserScan& scan, double& work) {
    const RayGeometry geometry{scan.readings, config_.ray_model, config_.hit_radius, config_.cell_size};
    const SensorOnGrid sensor(scan.T_map_sensor, config_.cell_size);
    const auto& beams = scan.fan.beams;
    for (bool first = true; done_ < beams.size() && (first || work > 0.0); ++done_, first = false) {
        const auto reading = reading_of(scan.ranges[done_], scan.readings);
        if (!reading) continue;
        work -= work_of_beam(*reading, geometry);
        trace_beam(marks_, beams[done_], *reading, sensor, geometry);
        while (config_.accumulate && !marks_.chunks().empty()) add_first_marks();
    }
    return done_ == beams.size();
}

bool LaserLayers::add_marks(double& work) {
    for (bool first = true; !marks_.chunks().empty() && (first || work > 0.0); first = false) {
        work -= kWorkPerChunk;
        add_first_marks();
    }
    return marks_.chunks().empty();
}

void LaserLayers::add_first_marks() {
    const auto first = marks_.take_first();
    const grid::ChunkKey key = first.key();
    const ChunkVerdicts verdicts = verdicts_of(first.mapped());
    include(bounds_.occupancy, key, verdicts);
    include(touched_, key, verdicts);
    if (LaserChunk* chunk = grid_.write(key)) simd::add_evidence(*chunk, verdicts, occupancy_);
}

/// Updates the HIMM counters for every model and, for the inverse sensor model, also the evidence and the classes that
/// follow from both.
bool LaserLayers::sweep(const LaserScan& scan, double& work) {
    std::array<Sweep::Band, Sweep::kBandsMax> bands;
    std::size_t count = 0;
    if (is_swept(config_)) bands[count++] = {scan.fan.occupancy.get(), config_.obstacle_thickness};
    bands[count++] = {scan.fan.himm.get(), config_.himm_obstacle_thickness};
    Sweep sweep({scan.ranges, scan.T_map_sensor, scan.readings, config_.cell_size}, std::span(bands).first(count));
    for (bool first = true; done_ < sweep.strips() && (first || work > 0.0); ++done_, first = false) {
        work -= static_cast<double>(scan.ranges.size());
        sweep.visit(done_, [&](grid::ChunkKey key, std::span<const ChunkVerdicts> verdicts) {
            work -= kWorkPerSweptChunk;
            integrate_chunk(key, verdicts);
        });
    }
    return done_ >= sweep.strips();
}

void LaserLayers::integrate_chunk(grid::ChunkKey key, std::span<const ChunkVerdicts> verdicts) {
    const ChunkVerdicts& counted = verdicts.back();
    include(bounds_.himm, key, counted);
    if (verdicts.size() == 1) { // the evidence was added by trace_beams()
        include(touched_, key, counted);
        if (LaserChunk* chunk = grid_.write(key)) simd::count_hits(*chunk, counted, himm_);
        return;
    }
    const ChunkVerdicts& seen = verdicts.front();
    include(bounds_.occupancy, key, seen);
    const LaserChunk* known = grid_.find(key);
    if (known != nullptr && simd::is_saturated(*known, seen, counted)) return;
    LaserChunk* chunk = grid_.write(key);
    if (chunk == nullptr) return;
    simd::count_hits(*chunk, counted, himm_);
    simd::add_evidence(*chunk, seen, occupancy_);
    const bool by_occupancy = config_.class_source == ClassSource::kOccupancy;
    update_types(*chunk, undecided(chunk->occ_types, by_occupancy ? seen : counted));
}

/// Returns the cells whose type the verdicts may change.
///
/// A verdict that equals the current type does not change it if evidence moves the value in the verdict's direction.
/// HIMM evidence always does; log-odds evidence does unless the prior lies beyond the model's value.
grid::BitPlane LaserLayers::undecided(const classify::OccPlanes& types, const ChunkVerdicts& verdicts) const {
    grid::BitPlane cells = touched_by(verdicts);
    if (config_.class_source == ClassSource::kOccupancy && (occupancy_.free > 0 || occupancy_.occupied < 0))
        return cells;
    for (std::size_t j = 0; j < cells.size(); ++j) {
        cells[j] &= ~((verdicts.free[j] & types.free[j]) | (verdicts.occupied[j] & types.occupied[j]));
    }
    return cells;
}

void LaserLayers::update_types(LaserChunk& chunk, const grid::BitPlane& touched) const {
    if (config_.class_source == ClassSource::kOccupancy) {
        simd::update_types(chunk, touched, by_occupancy_);
    } else {
        simd::update_types(chunk, touched, by_himm_);
    }
}

/// Updates the classes for models that trace rays, which may change a chunk more than once per scan.
bool LaserLayers::update_classes(double& work) {
    static constexpr grid::BitPlane kAllCells = all_cells();
    for (bool first = true; done_ < changed_.size() && (first || work > 0.0); ++done_, first = false) {
        work -= kWorkPerChunk;
        update_types(*grid_.write(changed_[done_]), kAllCells);
    }
    return done_ == changed_.size();
}

} // namespace scanloom::mapping
