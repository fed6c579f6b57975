#include "server/tiles/tile_maker.hpp"

#include "server/tiles/tile.hpp"

#include <utility>

namespace scanloom::tiles {
namespace {

/// The finest zoom whose drawings are kept. A tile of it shows 256 chunks; a tile of a finer zoom is drawn from its
/// cells about as fast as it is encoded.
constexpr std::uint32_t kKeptDrawingZoomMax = 7;

/// The coarsest zoom whose tiles count as a part of a map. A tile of a coarser zoom shows more than a thousand native
/// ones.
constexpr std::uint32_t kPartZoomMin = 5;

/// Compares owners, so that a new object at the address of a deleted one is different.
bool is_same(const std::weak_ptr<const void>& a, const std::shared_ptr<const void>& b) {
    return !a.owner_before(b) && !b.owner_before(a);
}

TilePlace codes_of(TilePlace place) {
    place.format = TileFormat::kCodes;
    return place;
}

} // namespace

SharedBytes TileMaker::find(const TilePlace& place, Revision revision) {
    if (revision != 0) return cache_.find(place, revision);
    const auto codes = untouched_codes(place.layer);
    return place.format == TileFormat::kPng ? tile_png(codes, place.layer) : codes;
}

bool TileMaker::is_quick(const std::shared_ptr<const void>& origin, const TilePlace& place, Revision revision) {
    return place.key.zoom >= kPartZoomMin || earlier_drawing(origin, codes_of(place), revision).bytes;
}

SharedBytes TileMaker::make(const TileSource& maps, const TilePlace& place, Revision revision) {
    if (revision == 0) return find(place, revision);
    return cache_.get(place, revision, [&]() -> KeptTile {
        if (place.format == TileFormat::kCodes) return draw(maps, place, revision);
        const auto codes = codes_of(place);
        auto drawn = draw(maps, codes, revision);
        auto png = tile_png(drawn.bytes, place.layer);
        if (place.key.zoom <= kKeptDrawingZoomMax) cache_.keep(codes, std::move(drawn));
        return {std::move(png), revision};
    });
}

/// Returns an earlier drawing to start from, without bytes if there is none.
///
/// The drawing must have the same origin. A replay job that runs again takes its snapshots at other moments, and the
/// revision of a change that was reverted later depends on whether a snapshot was taken in between.
KeptTile TileMaker::earlier_drawing(const std::shared_ptr<const void>& origin, const TilePlace& codes,
                                    Revision revision) {
    auto earlier = cache_.newest(codes);
    const bool is_usable = earlier.revision <= revision && is_same(earlier.origin, origin);
    return is_usable ? earlier : KeptTile{};
}

KeptTile TileMaker::draw(const TileSource& maps, const TilePlace& codes, Revision revision) {
    const auto earlier = earlier_drawing(maps.origin, codes, revision);
    auto drawn = earlier.bytes ? tile_codes(maps.snapshot, codes.layer, codes.key, {earlier.bytes, earlier.revision})
                               : tile_codes(maps.snapshot, codes.layer, codes.key);
    return {std::move(drawn), revision, maps.origin};
}

} // namespace scanloom::tiles
