#include "core/mapping/chunk_kernels.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/mapping/chunk_kernels.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scanloom::mapping::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kSide = grid::kChunkSide;
constexpr std::uint64_t kAll = ~std::uint64_t{0};

/// Returns the lanes for cells n, n + 1, ... of a row whose bits are set.
template <class D>
HWY_INLINE hn::Mask<D> LanesOf(D d, const std::uint64_t& row, std::size_t n) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&row);
    if constexpr (hn::MaxLanes(D()) >= 8) return hn::LoadMaskBits(d, bytes + n / 8);
    const std::uint64_t bits = row >> n;
    return hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
}

/// Sets the bits of a row for the lanes that are set; the inverse of LanesOf().
/// Precondition: these bits of the row are 0.
template <class D>
HWY_INLINE void KeepLanes(D d, hn::Mask<D> lanes, std::uint64_t& row, std::size_t n) {
    if constexpr (hn::MaxLanes(D()) >= 8) {
        hn::StoreMaskBits(d, lanes, reinterpret_cast<std::uint8_t*>(&row) + n / 8);
    } else {
        std::uint64_t bits = 0;
        hn::StoreMaskBits(d, lanes, reinterpret_cast<std::uint8_t*>(&bits));
        row |= bits << n;
    }
}

/// Returns the rows in which the verdicts may change a cell, one bit per row.
HWY_INLINE std::uint64_t RowsWithNews(const ChunkVerdicts& verdicts, const grid::BitPlane& saturated) {
    const hn::ScalableTag<std::uint64_t> d;
    std::uint64_t rows = verdicts.occupied_rows;
    for (std::size_t j = 0; j < kSide; j += hn::Lanes(d)) {
        const auto news = hn::AndNot(hn::LoadU(d, saturated.data() + j), hn::LoadU(d, verdicts.free.data() + j));
        std::uint64_t bits = 0;
        hn::StoreMaskBits(d, hn::Ne(news, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
        rows |= bits << j;
    }
    return rows;
}

/// Calls row(j) for each bit j that is set.
template <class Row>
HWY_INLINE void ForEachRow(std::uint64_t rows, Row&& row) {
    for (; rows != 0; rows &= rows - 1) row(hwy::Num0BitsBelowLS1Bit_Nonzero64(rows));
}

/// A step split into the part that one saturating addition can add and the rest, which is usually 0: a step from one
/// end of the clamp to the other may exceed the range of LogOdds.
struct Step {
    explicit Step(int whole)
        : first(static_cast<LogOdds>(std::clamp(whole, -32767, 32767))), rest(static_cast<LogOdds>(whole - first)) {}

    LogOdds first;
    LogOdds rest;
};

void AddEvidence(LaserChunk& chunk, const ChunkVerdicts& verdicts, const OccupancyRule& rule) {
    const hn::CappedTag<LogOdds, kSide> d;
    using V = hn::Vec<decltype(d)>;
    const Step free_step(rule.free);
    const Step occupied_step(rule.occupied);
    const V unknown = hn::Set(d, kUnknownLogOdds);
    const V prior = hn::Set(d, rule.prior);
    const V l_min = hn::Set(d, rule.l_min);
    const V l_max = hn::Set(d, rule.l_max);
    const V free = hn::Set(d, free_step.first);
    const V occupied = hn::Set(d, occupied_step.first);
    const V free_rest = hn::Set(d, free_step.rest);
    const V occupied_rest = hn::Set(d, occupied_step.rest);
    const bool has_rest = free_step.rest != 0 || occupied_step.rest != 0;
    const auto before = [&](V cells) HWY_ATTR { return hn::IfThenElse(hn::Eq(cells, unknown), prior, cells); };
    const auto clamped = [&](V cells) HWY_ATTR { return hn::Min(hn::Max(cells, l_min), l_max); };
    const bool can_saturate = rule.free <= 0;
    ForEachRow(RowsWithNews(verdicts, chunk.saturated_occupancy), [&](std::size_t j) HWY_ATTR {
        LogOdds* row = chunk.occupancy.data() + j * kSide;
        std::uint64_t saturated = 0;
        const bool is_plain = verdicts.free[j] == kAll && !has_rest;
        for (std::size_t n = 0; n < kSide; n += hn::Lanes(d)) {
            const V cells = hn::LoadU(d, row + n);
            V after;
            if (is_plain) {
                after = clamped(hn::SaturatedAdd(before(cells), free));
            } else {
                const auto is_free = LanesOf(d, verdicts.free[j], n);
                const auto is_occupied = LanesOf(d, verdicts.occupied[j], n);
                V sum = hn::SaturatedAdd(before(cells), hn::IfThenElse(is_occupied, occupied, free));
                if (has_rest) sum = hn::SaturatedAdd(sum, hn::IfThenElse(is_occupied, occupied_rest, free_rest));
                after = hn::IfThenElse(hn::Or(is_free, is_occupied), clamped(sum), cells);
            }
            hn::StoreU(after, d, row + n);
            KeepLanes(d, hn::Eq(after, l_min), saturated, n);
        }
        chunk.saturated_occupancy[j] = can_saturate ? saturated : 0;
    });
}

void CountHits(LaserChunk& chunk, const ChunkVerdicts& verdicts, const HimmRule& rule) {
    const hn::CappedTag<HimmCount, kSide> d;
    using V = hn::Vec<decltype(d)>;
    const V unseen = hn::Set(d, kUnseenHimm);
    const V most = hn::Set(d, kHimmMax);
    const V up = hn::Set(d, static_cast<HimmCount>(rule.up));
    const V down = hn::Set(d, static_cast<HimmCount>(rule.down));
    ForEachRow(RowsWithNews(verdicts, chunk.saturated_himm), [&](std::size_t j) HWY_ATTR {
        HimmCount* row = chunk.himm.data() + j * kSide;
        std::uint64_t saturated = 0;
        for (std::size_t n = 0; n < kSide; n += hn::Lanes(d)) {
            const auto is_free = LanesOf(d, verdicts.free[j], n);
            const auto is_occupied = LanesOf(d, verdicts.occupied[j], n);
            const V cells = hn::LoadU(d, row + n);
            const V known = hn::IfThenZeroElse(hn::Eq(cells, unseen), cells);
            const V counted =
                hn::IfThenElse(is_occupied, hn::Min(hn::SaturatedAdd(known, up), most), hn::SaturatedSub(known, down));
            const V after = hn::IfThenElse(hn::Or(is_free, is_occupied), counted, cells);
            hn::StoreU(after, d, row + n);
            KeepLanes(d, hn::Eq(after, hn::Zero(d)), saturated, n);
        }
        chunk.saturated_himm[j] = saturated;
    });
}

/// Masks of the cells that reach the limits of a type.
struct Limits {
    grid::BitPlane occupied{};
    grid::BitPlane free{};
    grid::BitPlane first_free{};
};

template <class Value>
HWY_INLINE void FindLimits(const Value* cells, const grid::BitPlane& touched, const classify::Hysteresis<Value>& rule,
                           Limits& limits) {
    const hn::CappedTag<Value, kSide> d;
    using V = hn::Vec<decltype(d)>;
    const V unseen = hn::Set(d, rule.unseen);
    const V occupied = hn::Set(d, rule.occupied);
    const V free = hn::Set(d, rule.free);
    const V first_free = hn::Set(d, rule.first_free);
    for (std::size_t j = 0; j < kSide; ++j, cells += kSide) {
        if (touched[j] == 0) continue;
        for (std::size_t n = 0; n < kSide; n += hn::Lanes(d)) {
            const V value = hn::LoadU(d, cells + n);
            const auto is_seen = hn::Ne(value, unseen);
            const auto keep_if_seen = [&](auto lanes, std::uint64_t& row)
                                          HWY_ATTR { KeepLanes(d, hn::And(is_seen, lanes), row, n); };
            keep_if_seen(hn::Eq(hn::Max(value, occupied), value), limits.occupied[j]); // value >= occupied
            keep_if_seen(hn::Eq(hn::Min(value, free), value), limits.free[j]);         // value <= free
            keep_if_seen(hn::Eq(hn::Min(value, first_free), value), limits.first_free[j]);
        }
    }
}

template <class Value>
HWY_INLINE void UpdateTypes(const Value* cells, const grid::BitPlane& touched, const classify::Hysteresis<Value>& rule,
                            classify::OccPlanes& types) {
    Limits limits;
    FindLimits(cells, touched, rule, limits);
    for (std::size_t j = 0; j < kSide; ++j) {
        const std::uint64_t known = types.free[j] | types.occupied[j];
        const std::uint64_t occupied = touched[j] & limits.occupied[j];
        const std::uint64_t low = (limits.free[j] & known) | (limits.first_free[j] & ~known);
        const std::uint64_t free = touched[j] & low & ~occupied;
        types.occupied[j] = (types.occupied[j] & ~free) | occupied;
        types.free[j] = (types.free[j] & ~occupied) | free;
    }
}

void UpdateTypesByOccupancy(LaserChunk& chunk, const grid::BitPlane& touched,
                            const classify::Hysteresis<LogOdds>& rule) {
    UpdateTypes(chunk.occupancy.data(), touched, rule, chunk.occ_types);
}

void UpdateTypesByHimm(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<HimmCount>& rule) {
    UpdateTypes(chunk.himm.data(), touched, rule, chunk.occ_types);
}

} // namespace scanloom::mapping::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scanloom::mapping::simd {

HWY_EXPORT(AddEvidence);
HWY_EXPORT(CountHits);
HWY_EXPORT(UpdateTypesByOccupancy);
HWY_EXPORT(UpdateTypesByHimm);

void add_evidence(LaserChunk& chunk, const ChunkVerdicts& verdicts, const OccupancyRule& rule) {
    HWY_DYNAMIC_DISPATCH(AddEvidence)(chunk, verdicts, rule);
}

void count_hits(LaserChunk& chunk, const ChunkVerdicts& verdicts, const HimmRule& rule) {
    HWY_DYNAMIC_DISPATCH(CountHits)(chunk, verdicts, rule);
}

void update_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<LogOdds>& by_occupancy) {
    HWY_DYNAMIC_DISPATCH(UpdateTypesByOccupancy)(chunk, touched, by_occupancy);
}

void update_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<HimmCount>& by_himm) {
    HWY_DYNAMIC_DISPATCH(UpdateTypesByHimm)(chunk, touched, by_himm);
}

} // namespace scanloom::mapping::simd
#endif
