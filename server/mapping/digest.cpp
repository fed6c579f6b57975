#include "server/mapping/digest.hpp"

#include "common/hash/sha256.hpp"

#include <boost/endian/buffers.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace scanloom::mapping {
namespace {

struct CanonicalChunk {
    boost::endian::little_int32_buf_t ci;
    boost::endian::little_int32_buf_t cj;
    std::array<boost::endian::little_int16_buf_t, std::size_t{grid::kChunkSide} * grid::kChunkSide> cells;
};
static_assert(sizeof(CanonicalChunk) == 8 + 2 * 4096, "hashed as it lies in memory");

} // namespace

std::string digest_of(const OccupancyView& view) {
    std::vector<std::pair<grid::ChunkKey, const OccupancyChunk*>> chunks;
    view.visit({}, 0, [&](grid::ChunkKey key, const OccupancyChunk& chunk) {
        const auto is_known = [](LogOdds cell) { return cell != kUnknownLogOdds; };
        if (std::any_of(chunk.cells.begin(), chunk.cells.end(), is_known)) chunks.emplace_back(key, &chunk);
    });
    std::sort(chunks.begin(), chunks.end());

    Sha256 hash;
    CanonicalChunk canonical;
    for (const auto& [key, chunk] : chunks) {
        canonical.ci = key.ci;
        canonical.cj = key.cj;
        std::copy(chunk->cells.begin(), chunk->cells.end(), canonical.cells.begin());
        hash.update(std::as_bytes(std::span(&canonical, 1)));
    }
    return hash.hex();
}

} // namespace scanloom::mapping
