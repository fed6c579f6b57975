#include "core/mapping/sweep/crossings.hpp"

#include "core/mapping/sweep/pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/mapping/sweep/crossings.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scanloom::mapping::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// Moves the lanes that are set to the front.
HWY_INLINE V Packed(V values, M lanes) {
#if HWY_TARGET == HWY_AVX3
    return V{_mm512_maskz_compress_pd(lanes.raw, values.raw)}; // Highway 1.0 copies a table of 2 KiB each time
#else
    return hn::Compress(values, lanes);
#endif
}

/// Appends the pieces of a vector that cross any row.
template <std::size_t numbers>
HWY_INLINE void Append(D d, Pieces<numbers>& pieces, M crossing, const std::array<V, numbers>& values) {
    if (hn::AllFalse(d, crossing)) return; // the usual case with large cells
    for (std::size_t k = 0; k < numbers; ++k) {
        hn::StoreU(Packed(values[k], crossing), d, pieces.of[k] + pieces.count);
    }
    pieces.count += hn::CountTrue(d, crossing);
}

inline void AppendArc(Pieces<kArcNumbers>& arcs, double from, double to, double square, bool on_the_left) {
    if (!(from < to)) return;
    arcs.of[kFrom][arcs.count] = from;
    arcs.of[kTo][arcs.count] = to;
    arcs.of[kSquare][arcs.count] = square;
    arcs.of[kSign][arcs.count] = on_the_left ? -0.0 : 0.0;
    ++arcs.count;
}

/// Appends an arc that passes the highest or lowest point of its circle: it rises on one side and falls on the other.
inline void AppendBentArc(Pieces<kArcNumbers>& arcs, const Edges& edges, double r, std::size_t n, const Strip& strip) {
    const double first = strip.row;
    const double end = first + strip.rows;
    const auto row_of = [&](double y) { return std::ceil(y + (strip.sensor_y - 0.5)); };
    const auto append = [&](double row, double other, double x) {
        AppendArc(arcs, std::max(std::min(row, other), first), std::min(std::max(row, other), end), r * r, x < 0.0);
    };
    const double turning = row_of(edges.y[n] + edges.y[n + 1] > 0.0 ? r : -r);
    append(row_of(r * edges.y[n]), turning, edges.x[n]);
    append(row_of(r * edges.y[n + 1]), turning, edges.x[n + 1]);
}

/// A point of a contour on an edge: its distance from the sensor, and the first row whose cell centres are at its
/// height or above.
struct Corner {
    HWY_INLINE Corner() {}
    HWY_INLINE Corner(V distance, V first_row) : radius(distance), row(first_row) {}

    V radius;
    V row;
};

/// The edges of the sectors in one vector, and the rows of the strip.
struct Sectors {
    V x0, y0, x1, y1;
    M are_sectors;
    V first_row, end_row;

    /// Appends the part of each selected sector's edge between two of its points, if it crosses any row.
    HWY_INLINE void AppendSpoke(Pieces<kSpokeNumbers>& spokes, M which, const Corner& one, const Corner& other) const {
        const V from = hn::Max(hn::Min(one.row, other.row), first_row);
        const V to = hn::Min(hn::Max(one.row, other.row), end_row);
        Append<kSpokeNumbers>(D(), spokes, hn::And(which, hn::Lt(from, to)),
                              {from, to, x0, y0, hn::Mul(one.radius, x0), hn::Mul(other.radius, x0)});
    }

    /// Appends the border of the area between two contours along an edge, each contour given by its points in the
    /// sector before the edge and in the sector after it. The border consists of the parts where the contours differ,
    /// paired so that the parts are shorter.
    HWY_INLINE void AppendSteps(Pieces<kSpokeNumbers>& spokes, M which, const Corner& inner_before,
                                const Corner& inner_here, const Corner& outer_before, const Corner& outer_here) const {
        const auto rows = [](const Corner& a, const Corner& b) HWY_ATTR { return hn::Abs(hn::Sub(a.row, b.row)); };
        const V along = hn::Add(rows(inner_before, inner_here), rows(outer_before, outer_here));
        const V across = hn::Add(rows(inner_before, outer_before), rows(inner_here, outer_here));
        const M goes_across = hn::Lt(across, along);
        const auto chosen = [&](const Corner& a, const Corner& b) HWY_ATTR {
            return Corner{hn::IfThenElse(goes_across, a.radius, b.radius), hn::IfThenElse(goes_across, a.row, b.row)};
        };
        AppendSpoke(spokes, which, inner_before, chosen(outer_before, inner_here));
        AppendSpoke(spokes, which, outer_here, chosen(inner_here, outer_before));
    }

    HWY_INLINE void AppendArcs(Pieces<kArcNumbers>& arcs, const Corner& start, V end_of_arc) const {
        const D d;
        const M on_the_left = hn::Lt(x0, hn::Zero(d));
        const V from = hn::Max(hn::Min(start.row, end_of_arc), first_row);
        const V to = hn::Min(hn::Max(start.row, end_of_arc), end_row);
        const M is_straight = hn::AndNot(AreBent(), are_sectors);
        Append<kArcNumbers>(
            d, arcs, hn::And(is_straight, hn::Lt(from, to)),
            {from, to, hn::Mul(start.radius, start.radius), hn::IfThenElseZero(on_the_left, hn::Set(d, -0.0))});
    }

    /// Selects the arcs that cross the y axis.
    [[nodiscard]] HWY_INLINE M AreBent() const {
        const V zero = hn::Zero(D());
        return hn::Xor(hn::Lt(x0, zero), hn::Lt(x1, zero));
    }
};

/// A step that rises by more rows than this is traced in one plane only; for smaller steps, that would cost more than
/// it saves.
constexpr double kSteep = 4.0;

/// Finds the pieces of each plane's border that cross rows of the strip.
template <std::size_t count>
HWY_INLINE void FindPieces(const Contours& contours, const Strip& strip,
                           std::array<Crossings, kContoursMax>& crossings) {
    const D d;
    const Edges& edges = contours.edges;
    const V offset = hn::Set(d, strip.sensor_y - 0.5);
    const auto row_of = [&](V y) HWY_ATTR { return hn::Ceil(hn::Add(y, offset)); };
    for (std::size_t n = 0; n < contours.sectors; n += hn::Lanes(d)) {
        const Sectors sectors{hn::LoadU(d, edges.x + n),           hn::LoadU(d, edges.y + n),
                              hn::LoadU(d, edges.x + n + 1),       hn::LoadU(d, edges.y + n + 1),
                              hn::FirstN(d, contours.sectors - n), hn::Set(d, strip.row),
                              hn::Set(d, strip.row + strip.rows)};
        Corner before[count];
        Corner start[count];
        V end[count];
        M has_spokes = hn::Lt(offset, offset);
        M has_arcs = has_spokes;
        for (std::size_t k = 0; k < count; ++k) {
            const V radius_before = hn::LoadU(d, contours.radius[k] + n - 1);
            const V radius = hn::LoadU(d, contours.radius[k] + n);
            before[k] = {radius_before, row_of(hn::Mul(radius_before, sectors.y0))};
            start[k] = {radius, row_of(hn::Mul(radius, sectors.y0))};
            end[k] = row_of(hn::Mul(radius, sectors.y1));
            has_spokes = hn::Or(has_spokes, hn::Ne(before[k].row, start[k].row));
            has_arcs = hn::Or(has_arcs, hn::Ne(start[k].row, end[k]));
        }
        if (!hn::AllFalse(d, has_spokes)) { // rare with large cells
            // Decided for each sector alone: the choice determines how a crossing is rounded and must not depend on how
            // many sectors a vector holds.
            const V rise = hn::Abs(hn::Sub(before[0].row, start[0].row));
            const M is_steep = hn::And(sectors.are_sectors, hn::Gt(rise, hn::Set(d, kSteep)));
            const M is_flat = hn::AndNot(is_steep, sectors.are_sectors);
            for (std::size_t k = 0; k < count; ++k)
                sectors.AppendSpoke(crossings[k].spokes, is_flat, before[k], start[k]);
            if (!hn::AllFalse(d, is_steep)) {
                sectors.AppendSpoke(crossings[0].steps, is_steep, before[0], start[0]);
                for (std::size_t k = 1; k < count; ++k) {
                    sectors.AppendSteps(crossings[k].steps, is_steep, before[k - 1], start[k - 1], before[k], start[k]);
                }
            }
        }
        for (std::size_t k = 0; k < count && !hn::AllFalse(d, has_arcs); ++k) {
            sectors.AppendArcs(crossings[k].arcs, start[k], end[k]);
        }
        if (hn::AllFalse(d, hn::And(sectors.are_sectors, sectors.AreBent()))) continue;
        for (std::size_t m = n; m < std::min(n + hn::Lanes(d), contours.sectors); ++m) {
            if ((edges.x[m] < 0.0) == (edges.x[m + 1] < 0.0)) continue;
            for (std::size_t k = 0; k < count; ++k) {
                if (contours.radius[k][m] > 0.0)
                    AppendBentArc(crossings[k].arcs, edges, contours.radius[k][m], m, strip);
            }
        }
    }
}

/// Flips bits of the given planes of a strip, several crossings at a time.
template <std::size_t plane_count>
class Flipper {
public:
    HWY_INLINE Flipper(const Strip& strip, const std::array<std::uint64_t*, plane_count>& planes)
        : planes_(planes), rows_(strip.rows), to_centre_(0.5 - strip.sensor_y), x_offset_(strip.sensor_x - 0.5),
          column_(strip.column), row_(strip.row), column_max_(strip.columns - 1) {}

    /// Returns the height of the rows' centres above the sensor.
    [[nodiscard]] HWY_INLINE V HeightOf(V row) const { return hn::Add(row, hn::Set(D(), to_centre_)); }

    /// Flips the bit at x in each of these rows.
    HWY_INLINE void Flip(V row, V x, std::size_t count) const {
        const D d;
        const hn::Rebind<std::int32_t, D> d32;
        const V column = hn::Sub(hn::Ceil(hn::Add(x, hn::Set(d, x_offset_))), hn::Set(d, column_));
        const V within = hn::Min(hn::Max(column, hn::Zero(d)), hn::Set(d, column_max_));
        const auto bits = hn::DemoteTo(d32, within);
        const auto rows = hn::DemoteTo(d32, hn::Sub(row, hn::Set(d, row_)));
        HWY_ALIGN std::int32_t bit[kLanesMax];
        HWY_ALIGN std::int32_t word[kLanesMax];
        hn::Store(bits, d32, bit);
        hn::Store(hn::Add(hn::Mul(hn::ShiftRight<6>(bits), hn::Set(d32, rows_)), rows), d32, word);
        if (count == hn::Lanes(d)) {
            for (std::size_t k = 0; k < hn::Lanes(d); ++k) FlipBit(word[k], bit[k]);
        } else {
            for (std::size_t k = 0; k < count; ++k) FlipBit(word[k], bit[k]);
        }
    }

private:
    HWY_INLINE void FlipBit(std::int32_t word, std::int32_t bit) const {
        const std::uint64_t flipped = std::uint64_t{1} << (bit & 63);
        for (std::uint64_t* plane : planes_) plane[word] ^= flipped;
    }

    std::array<std::uint64_t*, plane_count> planes_;
    std::int32_t rows_;
    double to_centre_;
    double x_offset_;
    double column_;
    double row_;
    double column_max_;
};

/// Flips a bit for each row of each piece: first the first row of all pieces, then the second row of those that have
/// one, and so on. The last few pieces are processed one at a time.
/// @param x_at  x_at(load, height) returns the crossings' x; load(k) returns the pieces' k-th number
template <std::size_t numbers, class Flipper, class XAt>
HWY_INLINE void FlipPieces(Pieces<numbers>& pieces, const Flipper& flipper, XAt&& x_at) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    while (pieces.count >= lanes) {
        std::size_t left = 0;
        for (std::size_t n = 0; n < pieces.count; n += lanes) {
            const auto load = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, pieces.of[k] + n); };
            const std::size_t count = std::min(lanes, pieces.count - n);
            const V row = load(kFrom);
            flipper.Flip(row, x_at(load, flipper.HeightOf(row)), count);
            const V next = hn::Add(row, hn::Set(d, 1.0));
            const M goes_on = hn::And(hn::FirstN(d, count), hn::Lt(next, load(kTo)));
            for (std::size_t k = 0; k < numbers; ++k) {
                hn::StoreU(Packed(k == kFrom ? next : load(k), goes_on), d, pieces.of[k] + left);
            }
            left += hn::CountTrue(d, goes_on);
        }
        pieces.count = left;
    }
    for (std::size_t n = 0; n < pieces.count; ++n) {
        const auto load = [&](std::size_t k) HWY_ATTR { return hn::Set(d, pieces.of[k][n]); };
        const double to = pieces.of[kTo][n];
        for (double from = pieces.of[kFrom][n]; from < to; from += static_cast<double>(lanes)) {
            const V rows = hn::Iota(d, from);
            const double missing = to - from;
            const std::size_t count = missing < static_cast<double>(lanes) ? static_cast<std::size_t>(missing) : lanes;
            flipper.Flip(rows, x_at(load, flipper.HeightOf(rows)), count);
        }
    }
}

/// Computes the slope and the limits of each spoke.
HWY_INLINE void MeasureSpokes(Pieces<kSpokeNumbers>& spokes) {
    const D d;
    for (std::size_t n = 0; n < spokes.count; n += hn::Lanes(d)) {
        const auto at = [&](std::size_t k) HWY_ATTR { return spokes.of[k] + n; };
        const V one = hn::LoadU(d, at(kOneEnd));
        const V other = hn::LoadU(d, at(kOtherEnd));
        hn::StoreU(hn::Div(hn::LoadU(d, at(kEdgeX)), hn::LoadU(d, at(kEdgeY))), d, at(kSlope));
        hn::StoreU(hn::Min(one, other), d, at(kLeft));
        hn::StoreU(hn::Max(one, other), d, at(kRight));
    }
}

/// Flips the crossings of a contour in the plane within it and in the next plane, if there is one; then the crossings
/// of the steps in the plane within it.
template <std::size_t plane_count>
HWY_INLINE void FlipContour(Crossings& crossings, const Strip& strip,
                            const std::array<std::uint64_t*, plane_count>& planes) {
    const D d;
    const auto x_of_spoke = [](const auto& load, V height) HWY_ATTR {
        return hn::Min(hn::Max(hn::Mul(load(kSlope), height), load(kLeft)), load(kRight)); // within the spoke
    };
    const auto x_of_arc = [d](const auto& load, V height) HWY_ATTR {
        const V square = hn::Max(hn::Zero(d), hn::Sub(load(kSquare), hn::Mul(height, height)));
        return hn::Or(hn::Sqrt(square), load(kSign));
    };
    MeasureSpokes(crossings.spokes);
    FlipPieces(crossings.spokes, Flipper<plane_count>(strip, planes), x_of_spoke);
    FlipPieces(crossings.arcs, Flipper<plane_count>(strip, planes), x_of_arc);
    MeasureSpokes(crossings.steps);
    FlipPieces(crossings.steps, Flipper<1>(strip, {planes[0]}), x_of_spoke);
}

void FlipCrossings(const Contours& contours, const Strip& strip, const Planes& planes) {
    auto crossings = room_for(contours.sectors, contours.count);
    contours.count == 2 ? FindPieces<2>(contours, strip, crossings) : FindPieces<4>(contours, strip, crossings);
    for (std::size_t k = 0; k + 1 < contours.count; ++k) {
        FlipContour<2>(crossings[k], strip, {planes[k], planes[k + 1]});
    }
    FlipContour<1>(crossings[contours.count - 1], strip, {planes[contours.count - 1]});
}

} // namespace scanloom::mapping::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scanloom::mapping::simd {

HWY_EXPORT(FlipCrossings);

void flip_crossings(const Contours& contours, const Strip& strip, const Planes& planes) {
    HWY_DYNAMIC_DISPATCH(FlipCrossings)(contours, strip, planes);
}

} // namespace scanloom::mapping::simd
#endif
