#include "core/mapping/beam_fan.hpp"

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::mapping {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Beams closer together than this have the same direction: the last beam of a full turn may repeat the first.
constexpr double kSameDirection = 1e-9;

/// Tolerance for comparing a gap with the aperture: if the aperture equals the spacing, rounding must not open a gap
/// between two beams.
constexpr double kSharedEdge = 1e-9;

/// Gaps between beams at explicit angles are blind if they exceed this multiple of the median gap.
constexpr double kBlindGaps = 4.0;

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

/// One side of a sector. Two sectors that meet hold exactly the same direction, so that each cell between them falls
/// into exactly one of them.
struct Edge {
    double angle;
    Direction direction;
};

/// Returns the gap from each beam to the next counter-clockwise; a full turn for a single beam.
std::vector<double> gaps_of(const std::vector<Beam>& beams) {
    std::vector<double> gaps(beams.size());
    for (std::size_t k = 0; k + 1 < beams.size(); ++k) gaps[k] = beams[k + 1].angle - beams[k].angle;
    gaps.back() = beams.front().angle + kTurn - beams.back().angle;
    return gaps;
}

/// The usual gap between beams, and the widest gap that they cover completely. Radians.
struct Spacing {
    double usual = 0.0;
    double widest = 0.0;
};

Spacing spacing_of(const BeamAngles& angles, std::vector<double> gaps) {
    if (gaps.size() < 2) return {};
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) {
        const double increment = std::abs(uniform->increment);
        return {increment, increment};
    }
    std::sort(gaps.begin(), gaps.end());
    const double median = gaps[(gaps.size() - 2) / 2]; // of all gaps except the widest
    return {median, kBlindGaps * median};
}

/// Appends the sectors of one beam.
void append_sectors(BeamFan& fan, std::uint32_t beam, const Edge& low, const Edge& high) {
    const double width = high.angle - low.angle;
    const int pieces = static_cast<int>(std::ceil(width / kSectorWidthMax - kSharedEdge));
    Sector sector{beam, low.direction, {}};
    for (int piece = 1; piece <= pieces; ++piece) {
        const bool last = piece == pieces;
        sector.high = last ? high.direction : direction_of(low.angle + width * piece / pieces);
        fan.push_back(sector);
        sector.low = sector.high;
    }
}

} // namespace

BeamFan make_beam_fan(const BeamAngles& angles, double aperture) {
    const auto beams = sorted_beams(angles);
    const std::size_t count = beams.size();
    const auto gaps = gaps_of(beams);
    const Spacing spacing = spacing_of(angles, gaps);
    const double half_width = std::min(std::max(aperture, spacing.usual), kTurn) / 2.0;
    const double gap_max = std::max(2.0 * half_width, spacing.widest);

    std::vector<Direction> bisectors(count);
    for (std::size_t k = 0; k < count; ++k) bisectors[k] = direction_of(beams[k].angle + gaps[k] / 2.0);
    /// A beam without a near neighbour covers half its width on that side. `side` is +1 for the counter-clockwise edge.
    const auto edge_of = [&](std::size_t beam, std::size_t gap, double side) -> Edge {
        if (gaps[gap] - gap_max <= kSharedEdge) return {beams[beam].angle + side * gaps[gap] / 2.0, bisectors[gap]};
        const double limit = beams[beam].angle + side * half_width;
        return {limit, direction_of(limit)};
    };

    BeamFan fan;
    fan.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        append_sectors(fan, beams[k].index, edge_of(k, (k + count - 1) % count, -1.0), edge_of(k, k, +1.0));
    }
    return fan;
}

} // namespace scanloom::mapping
