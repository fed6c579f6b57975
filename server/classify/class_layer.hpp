#pragma once

#include "server/classify/bit_plane.hpp"
#include "server/classify/cell_class.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>

namespace scanloom::classify {

/// The CellClass of every cell, kept up to date from the OccTypes.
///
/// FRONTIER  an UNEXPLORED cell with a FREE cell among the 8 around it; also in a chunk without OccTypes of its own.
/// DANGER    a FREE cell with an OCCUPIED cell at Chebyshev distance 1 .. danger_cells.
/// Else a cell's class is its OccType. The classes depend on nothing but the newest OccTypes: any sequence of updates
/// that ends with the same OccTypes gives the same classes.
/// A chunk's revision is that of the update in which one of its cells last got another class.
/// Thread  one writer; snapshots may be read by anyone.
class ClassLayer {
public:
    static constexpr std::int32_t kDangerCellsMax = grid::kChunkSide;

    /// The OccTypes of a chunk as they are now; nullptr where nothing was ever written: all unexplored.
    using FindPlanes = std::function<const OccPlanes*(grid::ChunkKey)>;

    /// Pre  1 <= danger_cells <= kDangerCellsMax.
    explicit ClassLayer(std::int32_t danger_cells);

    /// Takes in the OccTypes of the chunks that may have changed since the last update. find_planes is asked for those
    /// alone. Cost follows them, and those of their neighbours that a change at their border concerns; a chunk named
    /// without need costs a microsecond.
    /// Pre  revision >= that of every earlier update.
    void update(std::span<const grid::ChunkKey> changed, const FindPlanes& find_planes, Revision revision);

    /// How many chunks have a cell that is, or was once, not plainly UNEXPLORED.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return tree_.size(); }

    [[nodiscard]] ClassView snapshot() { return tree_.snapshot(); }

    /// See grid::ChunkTree::branch().
    [[nodiscard]] ClassLayer branch() { return {danger_cells_, planes_.branch(), tree_.branch()}; }

private:
    struct Planes {
        BitPlane free{};
        BitPlane occupied{};
        BitPlane frontier{}; // of the unexplored cells
        BitPlane danger{};   // of the free cells
    };
    struct PlanesChunk : grid::TreeItem {
        Planes planes;
    };
    struct Around; // a chunk's planes and those of its 8 neighbours

    struct KeyHash {
        [[nodiscard]] std::size_t operator()(grid::ChunkKey key) const noexcept;
    };
    using StaleChunks = std::unordered_map<grid::ChunkKey, BitPlane, KeyHash>; // with the cells of another OccType

    [[nodiscard]] static const std::shared_ptr<const PlanesChunk>& blank_planes();

    ClassLayer(std::int32_t danger_cells, grid::ChunkTree<PlanesChunk> planes, grid::ChunkTree<ClassChunk> tree)
        : danger_cells_(danger_cells), planes_(std::move(planes)), tree_(std::move(tree)) {}

    void take_in(grid::ChunkKey key, const OccPlanes* types, Revision revision, StaleChunks& stale);
    void classify(grid::ChunkKey key, const BitPlane& retyped, Revision revision);
    [[nodiscard]] Around around(grid::ChunkKey key) const;
    void write(grid::ChunkKey key, const Planes& planes, const BitPlane& reclassified, Revision revision);

    std::int32_t danger_cells_;
    grid::ChunkTree<PlanesChunk> planes_;
    grid::ChunkTree<ClassChunk> tree_;

public:
    /// What is kept of a chunk beside its OccTypes.
    static constexpr std::size_t kChunkBytes = sizeof(PlanesChunk) + sizeof(ClassChunk);
};

} // namespace scanloom::classify
