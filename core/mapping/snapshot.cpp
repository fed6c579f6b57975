#include "core/mapping/snapshot.hpp"

#include "common/hash/sha256.hpp"
#include "core/grid/chunk_areas.hpp"

#include <boost/endian/buffers.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::mapping {

grid::CellBox bounds_of(const Snapshot& snapshot, Layer layer) noexcept {
    const auto& [laser, sonar] = snapshot.bounds;
    switch (layer) {
    case Layer::kOccupancy: return laser.occupancy;
    case Layer::kHimm: return laser.himm;
    case Layer::kSonar: return sonar;
    case Layer::kClassification: {
        const grid::CellBox seen = snapshot.config.class_source == ClassSource::kHimm ? laser.himm : laser.occupancy;
        if (seen.empty()) return seen;
        return {seen.i_begin - 1, seen.j_begin - 1, seen.i_end + 1, seen.j_end + 1}; // frontiers surround free cells
    }
    }
    std::abort(); // each layer has a case
}

grid::CellBox bounds_of(const LayerBounds& bounds) noexcept {
    grid::CellBox all = bounds.laser.occupancy;
    all.include(bounds.laser.himm);
    all.include(bounds.sonar);
    return all;
}

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

namespace {

constexpr std::int32_t kReach = 2;

std::vector<grid::ChunkKey> chunks_of(const Snapshot& snapshot) {
    std::vector<grid::ChunkKey> chunks;
    const auto add = [&](grid::ChunkKey key, const auto&) { chunks.push_back(key); };
    snapshot.laser.visit(grid::kNumberedChunks, 0, add);
    snapshot.sonar.visit(grid::kNumberedChunks, 0, add);
    std::ranges::sort(chunks);
    chunks.erase(std::unique(chunks.begin(), chunks.end()), chunks.end());
    return chunks;
}

std::optional<grid::ChunkKey> chunk_at(const Pose2& pose, double cell_size) {
    const double chunk_m = cell_size * grid::kChunkSide;
    const double ci = std::floor(pose.x / chunk_m);
    const double cj = std::floor(pose.y / chunk_m);
    const auto end = static_cast<double>(grid::kNumberedChunkEnd);
    if (!(std::abs(ci) < end && std::abs(cj) < end)) return std::nullopt;
    return grid::ChunkKey{.cj = static_cast<std::int32_t>(cj), .ci = static_cast<std::int32_t>(ci)};
}

/// Clips a box to the cells that show anything, which is smaller than a box of whole chunks.
grid::CellBox clipped(const grid::CellBox& box, const grid::CellBox& to) {
    return {std::max(box.i_begin, to.i_begin), std::max(box.j_begin, to.j_begin), std::min(box.i_end, to.i_end),
            std::min(box.j_end, to.j_end)};
}

} // namespace

grid::CellBox main_bounds_of(const Snapshot& snapshot) {
    if (snapshot.chunk_count > kMainBoundsChunksMax) return {};
    grid::ChunkAreas areas(chunks_of(snapshot), kReach);
    grid::CellBox with_robots;
    for (const auto& robot : snapshot.robots) {
        if (!robot.pose) continue;
        if (const auto chunk = chunk_at(*robot.pose, snapshot.config.cell_size)) areas.take_around(*chunk, with_robots);
    }
    std::int64_t largest_count = areas.taken_count(); // a smaller area than these is not the largest
    grid::CellBox largest;
    for (const grid::ChunkKey key : areas.chunks()) {
        grid::CellBox area;
        const auto before = areas.taken_count();
        areas.take_around(key, area);
        const auto count = areas.taken_count() - before;
        if (count <= largest_count) continue;
        largest_count = count;
        largest = area;
    }
    with_robots.include(largest);
    return clipped(with_robots, bounds_of(snapshot));
}

} // namespace scanloom::mapping
