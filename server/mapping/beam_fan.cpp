#include "server/mapping/beam_fan.hpp"

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::mapping {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kQuarter = std::numbers::pi / 2.0;

/// Beams closer than this point the same way: the last beam of a full turn may repeat the first.
constexpr double kSameDirection = 1e-9;

/// A gap to the neighbour that is wider than the aperture by less than this is none: with the aperture
/// equal to the spacing, rounding must not open one between two beams.
constexpr double kSharedEdge = 1e-9;

struct Beam {
    double angle; // in (-pi, pi]
    std::uint32_t index;
};

std::vector<Beam> sorted_beams(const BeamAngles& angles) {
    std::vector<Beam> beams(beam_count(angles));
    for (std::uint32_t i = 0; i < beams.size(); ++i) beams[i] = {normalize_angle(beam_angle(angles, i)), i};
    std::sort(beams.begin(), beams.end(), [](const Beam& a, const Beam& b) { return a.angle < b.angle; });
    std::vector<Beam> distinct;
    distinct.reserve(beams.size());
    for (const Beam& beam : beams) {
        if (distinct.empty() || beam.angle - distinct.back().angle > kSameDirection) {
            distinct.push_back(beam);
        } else {
            distinct.back().index = std::min(distinct.back().index, beam.index);
        }
    }
    if (distinct.size() > 1 && distinct.front().angle + kTurn - distinct.back().angle <= kSameDirection) {
        distinct.front().index = std::min(distinct.front().index, distinct.back().index);
        distinct.pop_back();
    }
    return distinct;
}

Direction direction_of(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// One side of a sector. Two sectors that meet hold the very same direction, so that no cell falls
/// between them or into both.
struct Edge {
    double angle;
    Direction direction;
};

/// The edge of `beam` towards a neighbour `gap` away; `side` is +1 for the counter-clockwise edge,
/// `bisector` the direction half-way. A beam without a near neighbour sees to half its aperture.
Edge edge_towards(const Beam& beam, double gap, Direction bisector, double half_aperture, double side) {
    if (gap / 2.0 - half_aperture > kSharedEdge) {
        const double limit = beam.angle + side * half_aperture;
        return {limit, direction_of(limit)};
    }
    return {beam.angle + side * gap / 2.0, bisector};
}

/// Appends the sector in pieces of at most a quarter turn.
void append_sector(BeamFan& fan, std::uint32_t beam, const Edge& low, const Edge& high) {
    const double width = high.angle - low.angle;
    const int pieces = static_cast<int>(std::ceil(width / kQuarter - kSharedEdge));
    Sector sector{beam, low.direction, {}};
    for (int piece = 1; piece <= pieces; ++piece) {
        const bool last = piece == pieces;
        sector.high = last ? high.direction : direction_of(low.angle + width * piece / pieces);
        fan.push_back(sector);
        sector.low = sector.high;
    }
}

} // namespace

double beam_spacing(const BeamAngles& angles) {
    const std::size_t count = beam_count(angles);
    if (count < 2) return 0.0;
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) return std::abs(uniform->increment);
    auto sorted = std::get<ExplicitAngles>(angles);
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> gaps(count - 1);
    for (std::size_t i = 0; i + 1 < count; ++i) gaps[i] = sorted[i + 1] - sorted[i];
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    return *middle;
}

BeamFan make_beam_fan(const BeamAngles& angles, double aperture) {
    const auto beams = sorted_beams(angles);
    const std::size_t count = beams.size();
    const double half_aperture = std::min(std::max(aperture, beam_spacing(angles)), kTurn) / 2.0;

    std::vector<double> gaps(count); // from beam k to the next, a full turn for a single beam
    std::vector<Direction> bisectors(count);
    for (std::size_t k = 0; k < count; ++k) {
        gaps[k] = k + 1 < count ? beams[k + 1].angle - beams[k].angle : beams[0].angle + kTurn - beams[k].angle;
        bisectors[k] = direction_of(beams[k].angle + gaps[k] / 2.0);
    }

    BeamFan fan;
    fan.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t before = (k + count - 1) % count;
        append_sector(fan, beams[k].index, edge_towards(beams[k], gaps[before], bisectors[before], half_aperture, -1.0),
                      edge_towards(beams[k], gaps[k], bisectors[k], half_aperture, +1.0));
    }
    return fan;
}

} // namespace scanloom::mapping
