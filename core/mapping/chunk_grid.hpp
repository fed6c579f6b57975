#pragma once

#include "core/grid/chunk_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::mapping {

/// The chunks of one or more layers, written scan by scan.
///
/// A chunk restored from a checkpoint already contains all entries up to its revision. Entries up to that revision do
/// not change it when they are applied again.
/// Source: the page LSN of Mohan et al., ARIES (1992), section 6.
/// Threads: one writer; any number of threads may read snapshots.
template <class ChunkType>
class ChunkGrid {
public:
    /// Creates a grid without chunks.
    /// @param blank  contents of a chunk before its first write; not null
    explicit ChunkGrid(std::shared_ptr<const ChunkType> blank) : tree_(std::move(blank)) {}

    /// Starts the log entry `revision`. Call it before the entry's changes are written.
    /// @param revision  of the entry; greater than that of the entry before
    /// Precondition: revisions increase.
    void begin(Revision revision) {
        revision_ = revision;
        current_ = nullptr;
        if (revision > newest_restored_) restored_.clear();
    }

    /// Returns the chunk for writing by the current entry, or nullptr if the chunk already contains that entry.
    /// The pointer is valid until the next snapshot().
    /// @param key  any chunk
    [[nodiscard]] ChunkType* write(grid::ChunkKey key) {
        if (holds_already(key)) return nullptr;
        if (current_ == nullptr || key != current_key_) { // neighbouring runs are mostly in the same chunk
            current_ = &tree_.write(key, revision_);
            current_key_ = key;
        }
        return current_;
    }

    /// Returns the current chunk, or nullptr if it was never written. The pointer is valid until the next write.
    /// @param key  any chunk
    [[nodiscard]] const ChunkType* find(grid::ChunkKey key) const noexcept { return tree_.find(key); }

    /// Splits the cells i_begin..i_end - 1 of row j at chunk borders and calls change(chunk, i, count) for each part:
    /// the cells i..i + count - 1. Skips chunks that already contain the current entry.
    /// @param j        row
    /// @param i_begin  first column
    /// @param i_end    column after the last one
    /// @param change   called from left to right
    template <class Change>
    void write_row(std::int32_t j, std::int32_t i_begin, std::int32_t i_end, Change&& change) {
        for (std::int32_t i = i_begin; i < i_end;) {
            const grid::ChunkKey key = grid::chunk_of({i, j});
            const std::int32_t end = std::min(i_end, (key.ci + 1) * grid::kChunkSide);
            if (ChunkType* chunk = write(key)) {
                change(*chunk, i, static_cast<std::size_t>(end - i));
            }
            i = end;
        }
    }

    /// Restores a chunk of a checkpoint and returns it; the caller fills in its cells.
    /// @param key       a chunk that was not restored yet
    /// @param revision  of the chunk in the checkpoint; may be newer than the checkpoint's state
    [[nodiscard]] ChunkType& restore(grid::ChunkKey key, Revision revision) {
        restored_[key] = revision;
        newest_restored_ = std::max(newest_restored_, revision);
        return tree_.write(key, revision);
    }

    /// Returns the newest revision of all restored chunks; 0 if none was restored.
    [[nodiscard]] Revision newest_restored() const noexcept { return newest_restored_; }

    /// Returns the keys of the chunks that the current entry changed.
    /// @param box  contains all of these chunks
    [[nodiscard]] std::vector<grid::ChunkKey> changed_in(const grid::CellBox& box) const {
        std::vector<grid::ChunkKey> keys;
        tree_.peek().visit(grid::chunks_of(box), revision_ - 1, [&](grid::ChunkKey key, const ChunkType&) {
            if (!holds_already(key)) keys.push_back(key);
        });
        return keys;
    }

    /// Writes every chunk whose contents differ from that of `other`, as a change by the current entry. A chunk that
    /// `other` does not have becomes blank.
    /// @param other  not changed
    /// @param is_same  bool(const ChunkType&, const ChunkType&): whether their contents are equal
    template <class IsSame>
    void replace_with(const ChunkGrid& other, IsSame is_same) {
        const auto before = tree_.peek();
        const auto after = other.tree_.peek();
        const auto replace = [&](grid::ChunkKey key, const ChunkType& contents) {
            ChunkType& chunk = tree_.write(key, revision_);
            const Revision at = chunk.revision;
            chunk = contents;
            chunk.revision = at;
        };
        after.visit({}, 0, [&](grid::ChunkKey key, const ChunkType& contents) {
            const ChunkType* chunk = before.find(key);
            if (chunk == nullptr || !is_same(*chunk, contents)) replace(key, contents);
        });
        before.visit({}, 0, [&](grid::ChunkKey key, const ChunkType& chunk) {
            if (after.find(key) == nullptr && !is_same(chunk, tree_.blank())) replace(key, tree_.blank());
        });
        current_ = nullptr;
        restored_.clear();
    }

    /// Returns the number of chunks.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return tree_.size(); }

    /// See ChunkTree::copied().
    [[nodiscard]] std::size_t copied() const noexcept { return tree_.copied(); }

    /// See ChunkTree::branch().
    [[nodiscard]] ChunkGrid branch() {
        current_ = nullptr;
        return ChunkGrid(*this, tree_.branch());
    }

    /// Returns the current contents. Later writes do not change the snapshot.
    [[nodiscard]] grid::ChunkView<ChunkType> snapshot() {
        current_ = nullptr;
        return tree_.snapshot();
    }

private:
    ChunkGrid(const ChunkGrid& other, grid::ChunkTree<ChunkType> tree)
        : tree_(std::move(tree)), revision_(other.revision_), restored_(other.restored_),
          newest_restored_(other.newest_restored_) {}

    [[nodiscard]] bool holds_already(grid::ChunkKey key) const {
        if (restored_.empty()) return false;
        const auto restored = restored_.find(key);
        return restored != restored_.end() && revision_ <= restored->second;
    }

    grid::ChunkTree<ChunkType> tree_;
    Revision revision_ = 0;
    grid::ChunkKey current_key_;
    ChunkType* current_ = nullptr;
    std::map<grid::ChunkKey, Revision> restored_; // dropped once revision_ is greater than all of them
    Revision newest_restored_ = 0;
};

} // namespace scanloom::mapping
