#pragma once

#include "core/classify/bit_plane.hpp"
#include "core/classify/cell_class.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>

namespace scanloom::classify {

/// The CellClass of every cell, kept up to date from the OccTypes.
///
///   frontier  an unexplored cell with a free cell among the 8 around it, also in a chunk without OccTypes of its own
///   danger    a free cell with an occupied cell at a Chebyshev distance of 1..danger_cells
/// The class of any other cell is its OccType. The classes depend only on the current OccTypes: any sequence of updates
/// that ends with the same OccTypes gives the same classes.
///
/// A chunk's revision is that of the update that last changed the class of one of its cells.
/// Threads: one writer; any number of threads may read snapshots.
class ClassLayer {
public:
    /// The largest reach of the danger class, in cells: a cell's class depends on its chunk and the 8 around it only.
    static constexpr std::int32_t kDangerCellsMax = grid::kChunkSide;

    /// Returns the current OccTypes of a chunk, or nullptr if it was never written, i.e. all its cells are unexplored.
    using FindPlanes = std::function<const OccPlanes*(grid::ChunkKey)>;

    /// @param danger_cells  reach of the danger class in cells, 1..kDangerCellsMax
    explicit ClassLayer(std::int32_t danger_cells);

    /// Updates the classes from the OccTypes of changed chunks.
    /// @param changed  all chunks that may have changed since the last update; naming a chunk that did not change costs
    ///                 a microsecond
    /// @param find_planes  called for the chunks in `changed` only
    /// @param revision  of this update; not less than that of any earlier update
    /// Cost: proportional to the changed chunks and to those of their neighbours that a change near the border affects.
    void update(std::span<const grid::ChunkKey> changed, const FindPlanes& find_planes, Revision revision);

    /// Returns the number of chunks with a cell whose class is, or once was, other than unexplored.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return tree_.size(); }

    /// Returns the current classes. Later updates do not change the snapshot.
    [[nodiscard]] ClassView snapshot() { return tree_.snapshot(); }

    /// Returns a copy that has its own writer; see grid::ChunkTree::branch().
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
    /// Chunks to classify again, with the cells whose OccType changed.
    using StaleChunks = std::unordered_map<grid::ChunkKey, BitPlane, KeyHash>;

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
    /// Memory kept for a chunk in addition to its OccTypes, in bytes.
    static constexpr std::size_t kChunkBytes = sizeof(PlanesChunk) + sizeof(ClassChunk);
};

} // namespace scanloom::classify
