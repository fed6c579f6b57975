#include "server/mapping/laser_layers.hpp"

#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/map_patch_cells.hpp"
#include "server/mapping/work.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::mapping {
namespace {

LaserChunk blank_chunk() {
    LaserChunk chunk;
    chunk.occupancy.fill(kUnknownLogOdds);
    chunk.himm.fill(kUnseenHimm);
    chunk.occ_types.fill(classify::OccType::kUnexplored);
    return chunk;
}

/// Rounded as evidence is, so that evidence of exactly a threshold's probability, and a clamp there, reach it.
classify::Hysteresis<LogOdds> hysteresis_of_occupancy(const MapConfig& config) {
    const auto fixed = [](double p) {
        return static_cast<LogOdds>(std::lround(std::clamp(log_odds_of(p) * kLogOddsScale, -32766.0, 32767.0)));
    };
    const LogOdds occupied = fixed(config.class_p_occupied);
    const LogOdds free = std::min(fixed(config.class_p_free), static_cast<LogOdds>(occupied - 1));
    return {occupied, free, free, kUnknownLogOdds};
}

/// An unexplored cell is free when it is counted down to 0: a first hit leaves it at less than what a free cell may
/// have.
classify::Hysteresis<HimmCount> hysteresis_of_himm(const MapConfig& config) {
    return {static_cast<HimmCount>(config.class_himm_occupied), static_cast<HimmCount>(config.class_himm_free), 0,
            kUnseenHimm};
}

/// Calls row() for what the next sectors of a scan show, as many as the work allows.
/// @param done  sectors so far. @return whether that was the last.
template <class Row>
bool visit_sectors(const BeamFan& fan, const LaserScan& scan, const ModelGeometry& geometry, std::size_t& done,
                   double& work, Row&& row) {
    const auto missing = std::span(fan).subspan(done);
    const auto sectors = missing.first(sectors_within(work, missing, scan.ranges, geometry));
    inverse_sensor_model(sectors, scan.ranges, scan.T_map_sensor, geometry, row);
    done += sectors.size();
    return sectors.size() == missing.size();
}

} // namespace

LaserFan make_laser_fan(const MapConfig& config, const BeamAngles& angles, double aperture) {
    const double for_occupancy = aperture > 0.0 ? aperture : config.beam_aperture;
    const double for_himm = aperture > 0.0 ? aperture : config.himm_beam_aperture;
    LaserFan fan;
    fan.himm = std::make_shared<const BeamFan>(make_beam_fan(angles, for_himm));
    if (config.ray_model == RayModel::kInverseSensorModel) {
        const bool alike = for_occupancy == for_himm;
        fan.occupancy = alike ? fan.himm : std::make_shared<const BeamFan>(make_beam_fan(angles, for_occupancy));
        return fan;
    }
    fan.beams.reserve(beam_count(angles));
    for (std::size_t beam = 0; beam < beam_count(angles); ++beam) {
        const double angle = beam_angle(angles, beam);
        fan.beams.push_back({std::cos(angle), std::sin(angle)});
    }
    return fan;
}

LaserLayers::LaserLayers(const MapConfig& config) : LaserLayers(config, ChunkGrid<LaserChunk>(blank_chunk())) {}

LaserLayers::LaserLayers(const MapConfig& config, ChunkGrid<LaserChunk> grid)
    : config_(config), occupancy_(config), himm_(config), by_occupancy_(hysteresis_of_occupancy(config)),
      by_himm_(hysteresis_of_himm(config)), grid_(std::move(grid)) {}

bool LaserLayers::integrate(const LaserScan& scan, Revision revision, double& work) {
    grid_.begin(revision);
    if (stage_ == Stage::kOccupancy) {
        const bool by_sectors = config_.ray_model == RayModel::kInverseSensorModel;
        if (!(by_sectors ? add_sectors(scan, work) : trace_beams(scan, work))) return false;
        stage_ = Stage::kMarks;
    }
    if (stage_ == Stage::kMarks) {
        if (!add_marks(work)) return false;
        stage_ = Stage::kHimm;
        done_ = 0;
    }
    if (stage_ == Stage::kHimm) {
        if (!count(scan, work)) return false;
        stage_ = Stage::kClasses;
        done_ = 0;
        changed_ = grid_.changed_in(touched_);
    }
    if (!fold_classes(work)) return false;
    stage_ = Stage::kOccupancy;
    done_ = 0;
    touched_ = {};
    return true;
}

void LaserLayers::import(const MapPatch& patch, Revision revision) {
    grid_.begin(revision);
    for_each_cell_of(patch, config_.cell_size, [&](grid::Cell cell, MapCell to) { set(cell, to); });
    double unbounded = HUGE_VAL;
    changed_ = grid_.changed_in(touched_);
    static_cast<void>(fold_classes(unbounded));
    done_ = 0;
    touched_ = {};
}

void LaserLayers::set(grid::Cell cell, MapCell to) {
    if (to == MapCell::kUnknown) return;
    const Verdict verdict = to == MapCell::kOccupied ? Verdict::kOccupied : Verdict::kFree;
    bounds_.occupancy.include_row(cell.j, cell.i, cell.i + 1);
    bounds_.himm.include_row(cell.j, cell.i, cell.i + 1);
    touched_.include_row(cell.j, cell.i, cell.i + 1);
    grid_.write_row(cell.j, cell.i, cell.i + 1, [&](LaserChunk& chunk, std::int32_t i, std::size_t) {
        const auto at = grid::index_in_chunk({i, cell.j});
        if (verdict == Verdict::kFree && chunk.occupancy[at] != kUnknownLogOdds) return;
        chunk.occupancy[at] = occupancy_.certain(verdict);
        chunk.himm[at] = verdict == Verdict::kOccupied ? kHimmMax : 0;
    });
}

/// The inverse sensor model: cells by sectors.
bool LaserLayers::add_sectors(const LaserScan& scan, double& work) {
    const ModelGeometry geometry{scan.readings, config_.obstacle_thickness, config_.cell_size};
    return visit_sectors(*scan.fan.occupancy, scan, geometry, done_, work,
                         [&](Verdict verdict, std::int32_t j, std::int32_t begin, std::int32_t end) {
                             bounds_.occupancy.include_row(j, begin, end);
                             touched_.include_row(j, begin, end);
                             grid_.write_row(j, begin, end, [&](LaserChunk& chunk, std::int32_t i, std::size_t count) {
                                 occupancy_.apply({&chunk.occupancy[grid::index_in_chunk({i, j})], count}, verdict);
                             });
                         });
}

/// The models that trace rays: cells are marked first, as a hit beats all passes of a scan, or of a beam.
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
    const ChunkMarks& marks = first.mapped();
    const auto add = [&](std::int32_t row, std::uint64_t bits, Verdict verdict) {
        for_each_run(bits, [&](int begin, int end) {
            const std::int32_t left = key.ci * grid::kChunkSide;
            const std::int32_t j = key.cj * grid::kChunkSide + row;
            bounds_.occupancy.include_row(j, left + begin, left + end);
            touched_.include_row(j, left + begin, left + end);
            grid_.write_row(j, left + begin, left + end, [&](LaserChunk& chunk, std::int32_t i, std::size_t count) {
                occupancy_.apply({&chunk.occupancy[grid::index_in_chunk({i, j})], count}, verdict);
            });
        });
    };
    for (std::int32_t row = 0; row < grid::kChunkSide; ++row) {
        const auto r = static_cast<std::size_t>(row);
        add(row, marks.hit[r], Verdict::kOccupied);
        add(row, marks.passed[r] & ~marks.hit[r], Verdict::kFree);
    }
}

bool LaserLayers::count(const LaserScan& scan, double& work) {
    const ModelGeometry geometry{scan.readings, config_.himm_obstacle_thickness, config_.cell_size};
    return visit_sectors(*scan.fan.himm, scan, geometry, done_, work,
                         [&](Verdict verdict, std::int32_t j, std::int32_t begin, std::int32_t end) {
                             bounds_.himm.include_row(j, begin, end);
                             touched_.include_row(j, begin, end);
                             grid_.write_row(j, begin, end, [&](LaserChunk& chunk, std::int32_t i, std::size_t count) {
                                 himm_.apply({&chunk.himm[grid::index_in_chunk({i, j})], count}, verdict);
                             });
                         });
}

bool LaserLayers::fold_classes(double& work) {
    for (bool first = true; done_ < changed_.size() && (first || work > 0.0); ++done_, first = false) {
        work -= kWorkPerChunk;
        LaserChunk& chunk = *grid_.write(changed_[done_]);
        if (config_.class_source == ClassSource::kOccupancy) {
            by_occupancy_.fold(chunk.occupancy, chunk.occ_types);
        } else {
            by_himm_.fold(chunk.himm, chunk.occ_types);
        }
    }
    return done_ == changed_.size();
}

} // namespace scanloom::mapping
