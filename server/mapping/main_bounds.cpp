#include "server/mapping/main_bounds.hpp"

#include "server/grid/chunk_areas.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace scanloom::mapping {
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
