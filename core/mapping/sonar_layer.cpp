#include "core/mapping/sonar_layer.hpp"

#include "core/mapping/reach.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::mapping {
namespace {

const std::shared_ptr<const SonarChunk>& blank_sonar_chunk() {
    static const auto blank = [] {
        SonarChunk chunk;
        chunk.cells.fill(kUnknownLogOdds);
        return std::make_shared<const SonarChunk>(chunk);
    }();
    return blank;
}

} // namespace

SonarFan make_sonar_fan(const MapConfig& config, const BeamAngles& angles, double aperture) {
    SonarFan fan{aperture > 0.0 ? aperture : config.sonar_beam_aperture, {}};
    fan.cones.reserve(beam_count(angles));
    for (std::size_t beam = 0; beam < beam_count(angles); ++beam) {
        const double angle = beam_angle(angles, beam);
        fan.cones.push_back({angle, make_beam_fan(ExplicitAngles{angle}, fan.aperture)});
    }
    return fan;
}

double sonar_probability(Verdict region, double r, double range_max, double a, double half_aperture) noexcept {
    const double w = ((range_max - r) / range_max + (half_aperture - a) / half_aperture) / 2.0;
    return region == Verdict::kOccupied ? 0.5 + 0.5 * w : 0.5 * (1.0 - w);
}

SonarLayer::SonarLayer(const MapConfig& config) : SonarLayer(config, ChunkGrid<SonarChunk>(blank_sonar_chunk())) {}

SonarLayer::SonarLayer(const MapConfig& config, ChunkGrid<SonarChunk> grid)
    : config_(config), l_min_(to_fixed(log_odds_of(config.sonar_p_min))),
      l_max_(to_fixed(log_odds_of(config.sonar_p_max))), grid_(std::move(grid)) {}

bool SonarLayer::integrate(const SonarScan& scan, Revision revision, double& work) {
    grid_.begin(revision);
    const ModelGeometry geometry{scan.readings, config_.sonar_obstacle_thickness, config_.cell_size};
    const auto& cones = scan.fan.cones;
    for (bool first = true; done_ < cones.size() && (first || work > 0.0); ++done_, first = false) {
        work -= work_of_cone(scan.fan.aperture, scan.ranges[done_], geometry);
        add(scan, done_);
    }
    if (done_ < cones.size()) return false;
    done_ = 0;
    return true;
}

void SonarLayer::replace_with(SonarLayer other, Revision revision) {
    grid_.begin(revision);
    grid_.replace_with(other.grid_, [](const SonarChunk& a, const SonarChunk& b) { return a.cells == b.cells; });
    bounds_ = other.bounds_;
}

void SonarLayer::add(const SonarScan& scan, std::size_t cone) {
    const ModelGeometry geometry{scan.readings, config_.sonar_obstacle_thickness, config_.cell_size};
    const double axis = scan.T_map_sensor.yaw + scan.fan.cones[cone].angle;
    const double ax = std::cos(axis);
    const double ay = std::sin(axis);
    const double half = scan.fan.aperture / 2.0;
    const auto paint = [&](Verdict region, std::int32_t j, std::int32_t begin, std::int32_t end) {
        bounds_.include_row(j, begin, end);
        const double dy = (j + 0.5) * config_.cell_size - scan.T_map_sensor.y;
        grid_.write_row(j, begin, end, [&](SonarChunk& chunk, std::int32_t i, std::size_t count) {
            for (LogOdds& cell : std::span(&chunk.at({i, j}), count)) {
                const double dx = (i + 0.5) * config_.cell_size - scan.T_map_sensor.x;
                const double a = std::abs(std::atan2(ax * dy - ay * dx, ax * dx + ay * dy));
                const int step = step_of(region, std::hypot(dx, dy), scan.readings.range_max, a, half);
                const int before = cell == kUnknownLogOdds ? 0 : cell;
                cell = static_cast<LogOdds>(std::clamp<int>(before + step, l_min_, l_max_));
                ++i;
            }
        });
    };
    inverse_sensor_model(scan.fan.cones[cone].sectors, scan.ranges.subspan(cone, 1), scan.T_map_sensor, geometry,
                         paint);
}

int SonarLayer::step_of(Verdict region, double r, double range_max, double a, double half_aperture) const noexcept {
    const double p = std::min(sonar_probability(region, r, range_max, a, half_aperture), config_.sonar_p_occupied_max);
    // An echo may report certainty that a cell is free, p = 0; the step is then the largest that a cell can take.
    const int furthest = l_max_ - l_min_;
    if (p <= 0.0) return -furthest;
    return static_cast<int>(std::clamp(std::round(log_odds_of(p) * kLogOddsScale), -1.0 * furthest, 1.0 * furthest));
}

} // namespace scanloom::mapping
