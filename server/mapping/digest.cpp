#include "server/mapping/digest.hpp"

#include "common/hash/sha256.hpp"
#include "server/mapping/layer_cells.hpp"

#include <boost/endian/buffers.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::mapping {
namespace {

static_assert(std::endian::native == std::endian::little, "cells are hashed as they lie in memory");

} // namespace

std::string digest_of(const Snapshot& snapshot, Layer layer) {
    return with_layer(snapshot, layer, [&](const auto& view, auto&& cells_of) {
        std::vector<std::pair<grid::ChunkKey, std::span<const std::byte>>> chunks;
        view.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) {
            const auto& cells = cells_of(chunk);
            if (std::ranges::any_of(cells, [](auto cell) { return is_known(cell); })) {
                chunks.emplace_back(key, std::as_bytes(std::span(cells)));
            }
        });
        std::sort(chunks.begin(), chunks.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

        Sha256 hash;
        const boost::endian::little_float64_buf_t cell_size(snapshot.config.cell_size);
        hash.update(std::as_bytes(std::span(&cell_size, 1)));
        for (const auto& [key, cells] : chunks) {
            const std::array<boost::endian::little_int32_buf_t, 2> at{boost::endian::little_int32_buf_t(key.ci),
                                                                      boost::endian::little_int32_buf_t(key.cj)};
            hash.update(std::as_bytes(std::span(at)));
            hash.update(cells);
        }
        return hash.hex();
    });
}

} // namespace scanloom::mapping
