#include "core/mapping/sweep/contours.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/mapping/sweep/contours.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scanloom::mapping::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

void TurnEdges(const FanRing& ring, double cosine, double sine, const Edges& turned) {
    const D d;
    const V c = hn::Set(d, cosine);
    const V s = hn::Set(d, sine);
    for (std::size_t n = 0; n < ring.sectors + 1; n += hn::Lanes(d)) {
        const V ex = hn::LoadU(d, ring.edges_x.data() + n);
        const V ey = hn::LoadU(d, ring.edges_y.data() + n);
        const V x = hn::Sub(hn::Mul(c, ex), hn::Mul(s, ey));
        const V y = hn::Add(hn::Mul(s, ex), hn::Mul(c, ey));
        hn::StoreU(x, d, turned.x + n);
        hn::StoreU(y, d, turned.y + n);
    }
}

void RadiiOf(const std::int32_t* millimetres, std::size_t sectors, const RadiusRule& rule, double* inner,
             double* outer) {
    const D d;
    const hn::Rebind<std::int32_t, D> d32;
    const V zero = hn::Zero(d);
    const V range_min = hn::Set(d, rule.range_min);
    const V range_max = hn::Set(d, rule.range_max);
    const V half_band = hn::Set(d, rule.half_band);
    const V per_metre = hn::Set(d, rule.cells_per_metre);
    const V unreturned = hn::Set(d, rule.drop_no_return ? 0.0 : rule.range_max);
    for (std::size_t n = 0; n < sectors; n += hn::Lanes(d)) {
        const V whole = hn::PromoteTo(d, hn::LoadU(d32, millimetres + n));
        const V metres = hn::Mul(whole, hn::Set(d, 0.001));
        const M seen = hn::And(hn::Gt(whole, zero), hn::Ge(hn::Min(metres, range_max), range_min));
        const M hit = hn::Lt(metres, range_max);
        const V near_end = hn::IfThenElse(hit, hn::Max(zero, hn::Sub(metres, half_band)), unreturned);
        const V far_end = hn::IfThenElse(hit, hn::Min(range_max, hn::Add(metres, half_band)), unreturned);
        hn::StoreU(hn::IfThenElseZero(seen, hn::Mul(near_end, per_metre)), d, inner + n);
        hn::StoreU(hn::IfThenElseZero(seen, hn::Mul(far_end, per_metre)), d, outer + n);
    }
}

Box BoxOf(const Contours& contours) {
    const D d;
    const V zero = hn::Zero(d);
    V x_min = zero;
    V x_max = zero;
    V y_min = zero;
    V y_max = zero;
    const auto include = [&](V x, V y) HWY_ATTR {
        x_min = hn::Min(x_min, x);
        x_max = hn::Max(x_max, x);
        y_min = hn::Min(y_min, y);
        y_max = hn::Max(y_max, y);
    };
    const double* radius = contours.radius[contours.count - 1];
    for (std::size_t n = 0; n < contours.sectors; n += hn::Lanes(d)) {
        const V r = hn::IfThenElseZero(hn::FirstN(d, contours.sectors - n), hn::LoadU(d, radius + n));
        const V ex0 = hn::LoadU(d, contours.edges.x + n);
        const V ey0 = hn::LoadU(d, contours.edges.y + n);
        const V ex1 = hn::LoadU(d, contours.edges.x + n + 1);
        const V ey1 = hn::LoadU(d, contours.edges.y + n + 1);
        include(hn::Mul(r, ex0), hn::Mul(r, ey0));
        include(hn::Mul(r, ex1), hn::Mul(r, ey1));
        const M through_x = hn::Xor(hn::Lt(ey0, zero), hn::Lt(ey1, zero)); // the arc's extreme point
        const M through_y = hn::Xor(hn::Lt(ex0, zero), hn::Lt(ex1, zero));
        if (hn::AllFalse(d, hn::Or(through_x, through_y))) continue;
        include(hn::IfThenElseZero(through_x, hn::CopySign(r, ex0)),
                hn::IfThenElseZero(through_y, hn::CopySign(r, ey0)));
    }
    return {hn::GetLane(hn::MinOfLanes(d, x_min)), hn::GetLane(hn::MinOfLanes(d, y_min)),
            hn::GetLane(hn::MaxOfLanes(d, x_max)), hn::GetLane(hn::MaxOfLanes(d, y_max))};
}

} // namespace scanloom::mapping::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scanloom::mapping::simd {

HWY_EXPORT(TurnEdges);
HWY_EXPORT(RadiiOf);
HWY_EXPORT(BoxOf);

void turn_edges(const FanRing& ring, double cosine, double sine, const Edges& turned) {
    HWY_DYNAMIC_DISPATCH(TurnEdges)(ring, cosine, sine, turned);
}

void radii_of(const std::int32_t* millimetres, std::size_t sectors, const RadiusRule& rule, double* inner,
              double* outer) {
    HWY_DYNAMIC_DISPATCH(RadiiOf)(millimetres, sectors, rule, inner, outer);
}

Box box_of(const Contours& contours) { return HWY_DYNAMIC_DISPATCH(BoxOf)(contours); }

} // namespace scanloom::mapping::simd
#endif
