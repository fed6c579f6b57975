#pragma once

#include "server/grid/chunk_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::mapping {

/// The chunks of some layers, written scan by scan; those put back from a checkpoint know which scans they hold.
///
/// A chunk of a checkpoint holds everything up to its revision already, so that scans up to that one leave it as it is
/// when they are woven again.
/// Source  the page LSN of Mohan et al., ARIES (1992), section 6.
/// Thread  one writer; snapshots may be read by anyone.
template <class ChunkType>
class ChunkGrid {
public:
    explicit ChunkGrid(std::shared_ptr<const ChunkType> blank) : tree_(std::move(blank)) {}

    /// To be called before the entry of that revision is woven. Pre: revisions rise.
    void begin(Revision revision) {
        revision_ = revision;
        current_ = nullptr;
        if (revision > newest_restored_) restored_.clear();
    }

    /// The chunk, to be written by the entry begun last; nullptr where it holds that entry already.
    /// Valid until the next snapshot().
    [[nodiscard]] ChunkType* write(grid::ChunkKey key) {
        if (holds_already(key)) return nullptr;
        if (current_ == nullptr || key != current_key_) { // neighbouring runs mostly fall into the same chunk
            current_ = &tree_.write(key, revision_);
            current_key_ = key;
        }
        return current_;
    }

    /// The chunk as it is now, or nullptr where nothing was ever written. Valid until the next write.
    [[nodiscard]] const ChunkType* find(grid::ChunkKey key) const noexcept { return tree_.find(key); }

    /// Calls change(chunk, i, count) for each piece, cells i..i + count - 1, of the cells i_begin..i_end - 1 of row j
    /// that lies in one chunk. Leaves out chunks that hold the entry already.
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

    /// Puts back a chunk of a checkpoint and returns it to be filled in.
    [[nodiscard]] ChunkType& restore(grid::ChunkKey key, Revision revision) {
        restored_[key] = revision;
        newest_restored_ = std::max(newest_restored_, revision);
        return tree_.write(key, revision);
    }

    /// The newest revision of any chunk put back.
    [[nodiscard]] Revision newest_restored() const noexcept { return newest_restored_; }

    /// The keys of the chunks that the entry begun last has changed, all of them lying in the box.
    [[nodiscard]] std::vector<grid::ChunkKey> changed_in(const grid::CellBox& box) const {
        std::vector<grid::ChunkKey> keys;
        tree_.peek().visit(grid::chunks_of(box), revision_ - 1, [&](grid::ChunkKey key, const ChunkType&) {
            if (!holds_already(key)) keys.push_back(key);
        });
        return keys;
    }

    [[nodiscard]] std::size_t chunk_count() const noexcept { return tree_.size(); }

    /// See ChunkTree::copied().
    [[nodiscard]] std::size_t copied() const noexcept { return tree_.copied(); }

    /// See ChunkTree::branch().
    [[nodiscard]] ChunkGrid branch() {
        current_ = nullptr;
        return ChunkGrid(*this, tree_.branch());
    }

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
    std::map<grid::ChunkKey, Revision> restored_; // dropped once all of them are overtaken
    Revision newest_restored_ = 0;
};

} // namespace scanloom::mapping
