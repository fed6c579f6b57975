#include "core/mapping/sweep/fill.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/mapping/sweep/fill.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scanloom::mapping::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D64 = hn::ScalableTag<std::uint64_t>;
using V64 = hn::Vec<D64>;

/// Returns all ones where the highest bit is set, zeros elsewhere.
HWY_INLINE V64 Spread(V64 word) {
    const D64 d;
    const hn::RebindToSigned<D64> ds;
    return hn::BitCast(d, hn::BroadcastSignBit(hn::BitCast(ds, word)));
}

/// Returns for each bit the parity of the bits up to and including it.
HWY_INLINE V64 Parity(V64 word) {
    word = hn::Xor(word, hn::ShiftLeft<1>(word));
    word = hn::Xor(word, hn::ShiftLeft<2>(word));
    word = hn::Xor(word, hn::ShiftLeft<4>(word));
    word = hn::Xor(word, hn::ShiftLeft<8>(word));
    word = hn::Xor(word, hn::ShiftLeft<16>(word));
    return hn::Xor(word, hn::ShiftLeft<32>(word));
}

HWY_INLINE bool AnySet(const std::uint64_t* words) {
    const D64 d;
    V64 all = hn::Zero(d);
    for (std::size_t n = 0; n < 64; n += hn::Lanes(d)) all = hn::Or(all, hn::LoadU(d, words + n));
    return !hn::AllFalse(d, hn::Ne(all, hn::Zero(d)));
}

/// Writes the cells inside to `inside`, clears `words` and updates `carry`.
HWY_INLINE void Fill(std::uint64_t* words, std::uint64_t* carry, std::uint64_t* inside) {
    const D64 d;
    for (std::size_t n = 0; n < 64; n += hn::Lanes(d)) {
        const V64 filled = hn::Xor(Parity(hn::LoadU(d, words + n)), hn::LoadU(d, carry + n));
        hn::StoreU(filled, d, inside + n);
        hn::StoreU(Spread(filled), d, carry + n);
        hn::StoreU(hn::Zero(d), d, words + n);
    }
}

HWY_INLINE void FillOrCarry(std::uint64_t* words, std::uint64_t* carry, std::uint64_t* inside) {
    const D64 d;
    if (AnySet(words)) return Fill(words, carry, inside);
    for (std::size_t n = 0; n < 64; n += hn::Lanes(d)) hn::StoreU(hn::LoadU(d, carry + n), d, inside + n);
}

/// Sets in `rows` one bit for each word that is not 0.
HWY_INLINE void KeepRows(V64 words, std::size_t n, std::uint64_t& rows) {
    const D64 d;
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Ne(words, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    rows |= bits << n;
}

/// Stores the free and the occupied cells of 64 rows, and which of the rows have any.
template <class Free, class Occupied>
HWY_INLINE void Keep(ChunkVerdicts& verdicts, Free&& free_at, Occupied&& occupied_at) {
    const D64 d;
    verdicts.free_rows = 0;
    verdicts.occupied_rows = 0;
    for (std::size_t n = 0; n < 64; n += hn::Lanes(d)) {
        const V64 free = free_at(n);
        const V64 occupied = occupied_at(n);
        hn::StoreU(free, d, verdicts.free.data() + n);
        hn::StoreU(occupied, d, verdicts.occupied.data() + n);
        KeepRows(free, n, verdicts.free_rows);
        KeepRows(occupied, n, verdicts.occupied_rows);
    }
}

void FillBands(const ChunkWords& words, std::size_t contours, ChunkVerdicts& narrow, ChunkVerdicts* wide) {
    const D64 d;
    HWY_ALIGN std::uint64_t filled[kContoursMax][64];
    for (std::size_t k = 0; k < contours; ++k) FillOrCarry(words.flipped[k], words.carry[k], filled[k]);
    const auto plane = [&](std::size_t k, std::size_t n) HWY_ATTR { return hn::Load(d, filled[k] + n); };
    if (contours == 2) {
        return Keep(
            narrow, [&](std::size_t n) HWY_ATTR { return plane(0, n); },
            [&](std::size_t n) HWY_ATTR { return hn::AndNot(plane(0, n), plane(1, n)); });
    }
    Keep(
        narrow, [&](std::size_t n) HWY_ATTR { return hn::Or(plane(0, n), plane(1, n)); },
        [&](std::size_t n) HWY_ATTR { return hn::AndNot(hn::Or(plane(0, n), plane(1, n)), plane(2, n)); });
    Keep(
        *wide, [&](std::size_t n) HWY_ATTR { return plane(0, n); },
        [&](std::size_t n)
            HWY_ATTR { return hn::AndNot(plane(0, n), hn::Or(hn::Or(plane(1, n), plane(2, n)), plane(3, n))); });
}

} // namespace scanloom::mapping::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scanloom::mapping::simd {

HWY_EXPORT(FillBands);

void fill_bands(const ChunkWords& words, std::size_t contours, ChunkVerdicts& narrow, ChunkVerdicts* wide) {
    HWY_DYNAMIC_DISPATCH(FillBands)(words, contours, narrow, wide);
}

} // namespace scanloom::mapping::simd
#endif
