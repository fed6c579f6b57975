#pragma once

#include "core/grid/chunk.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

namespace scanloom::grid {

namespace tree {

inline constexpr int kFanBits = 3;
inline constexpr std::uint32_t kFan = 1U << kFanBits; ///< children of a node along each axis

/// An inner node of 8 x 8 children: nodes of the level below, or chunks at the lowest.
struct Node : TreeItem {
    std::array<ItemRef<TreeItem>, std::size_t{kFan} * kFan> children;
};

/// One of the four trees around the origin.
///
/// Along each axis, chunks are counted away from the origin (0, 1, 2, ... or -1, -2, -3, ... as 0, 1, 2), so that the
/// tree can grow outwards without limit: a new root takes the old one as its first child. `height` levels of nodes
/// cover 8^height chunks along each axis.
struct Quadrant {
    ItemRef<Node> root;
    int height = 0;
};

using Quadrants = std::array<Quadrant, 4>; ///< by (cj < 0) * 2 + (ci < 0)

/// Returns the distance of a chunk index from the origin: 0, 1, 2, ... or -1, -2, -3, ... as 0, 1, 2, ...
[[nodiscard]] constexpr std::uint32_t away_from_origin(std::int32_t c) noexcept {
    return static_cast<std::uint32_t>(c < 0 ? ~c : c);
}

[[nodiscard]] constexpr std::size_t quadrant_of(ChunkKey key) noexcept {
    return static_cast<std::size_t>((key.cj < 0 ? 2 : 0) + (key.ci < 0 ? 1 : 0));
}

/// Returns whether a tree of this height contains index u, counted away from the origin.
[[nodiscard]] constexpr bool reaches(int height, std::uint32_t u) noexcept {
    return height * kFanBits >= 32 || (u >> (height * kFanBits)) == 0;
}

/// Returns the child slot of chunk (u, v) in a node of `level`. The children of level 1 are chunks.
[[nodiscard]] constexpr std::size_t slot_of(std::uint32_t u, std::uint32_t v, int level) noexcept {
    const int shift = (level - 1) * kFanBits;
    return ((v >> shift) & (kFan - 1)) << kFanBits | ((u >> shift) & (kFan - 1));
}

/// The chunk, or nullptr where nothing was ever written.
[[nodiscard]] inline const TreeItem* find(const Quadrants& quadrants, ChunkKey key) noexcept {
    const auto& quadrant = quadrants[quadrant_of(key)];
    const std::uint32_t u = away_from_origin(key.ci);
    const std::uint32_t v = away_from_origin(key.cj);
    if (!reaches(quadrant.height, u | v)) return nullptr;
    const TreeItem* item = quadrant.root.get();
    for (int level = quadrant.height; item != nullptr && level > 0; --level) {
        item = static_cast<const Node*>(item)->children[slot_of(u, v, level)].get();
    }
    return item;
}

} // namespace tree

/// The contents of a ChunkTree at one moment: immutable, shared, cheap to copy.
/// Threads: any number of readers.
template <class ChunkType>
class ChunkView {
public:
    ChunkView() = default;
    /// Creates a view of the contents of a tree. Obtain views from ChunkTree::snapshot() instead.
    explicit ChunkView(tree::Quadrants quadrants) : quadrants_(std::move(quadrants)) {}

    /// Returns the chunk, or nullptr if no cell of it was ever written. The pointer is valid as long as this view.
    [[nodiscard]] const ChunkType* find(ChunkKey key) const noexcept {
        return static_cast<const ChunkType*>(tree::find(quadrants_, key));
    }

    /// Calls visit(ChunkKey, const ChunkType&) for every chunk in the box that changed after revision `since`, in no
    /// particular order.
    /// @param box    chunks to visit
    /// @param since  chunks with this revision or an older one are skipped; 0: all are visited
    /// @param visit  called in the thread of the caller
    /// Cost: proportional to the chunks visited, independent of the size of the tree.
    template <class Visit>
    void visit(const ChunkBox& box, Revision since, Visit&& visit) const {
        for_each_root(box, [&](const Walk& walk) { descend(walk, box, since, visit); });
    }

    /// Returns the newest revision of any chunk in the box; 0 if there is none.
    /// @param box  chunks to search
    [[nodiscard]] Revision newest(const ChunkBox& box) const {
        Revision newest = 0;
        for_each_root(box, [&](const Walk& walk) { newest_below(walk, box, newest); });
        return newest;
    }

private:
    /// A node and the block of chunks that it covers, starting at (u0, v0), counted away from the origin in a quadrant.
    struct Walk {
        const TreeItem* item;
        int level;
        std::size_t quadrant;
        std::uint64_t u0;
        std::uint64_t v0;

        [[nodiscard]] ChunkBox box() const noexcept {
            const auto side = std::int64_t{1} << (level * tree::kFanBits);
            const auto u = static_cast<std::int64_t>(u0);
            const auto v = static_cast<std::int64_t>(v0);
            const bool left = (quadrant & 1) != 0;
            const bool below = (quadrant & 2) != 0;
            return {left ? -(u + side) : u, below ? -(v + side) : v, left ? -u : u + side, below ? -v : v + side};
        }
    };

    template <class Each>
    void for_each_root(const ChunkBox& box, Each&& each) const {
        for (std::size_t q = 0; q < quadrants_.size(); ++q) {
            if (!quadrants_[q].root) continue;
            const Walk walk{quadrants_[q].root.get(), quadrants_[q].height, q, 0, 0};
            if (walk.box().intersects(box)) each(walk);
        }
    }

    template <class Each>
    static void for_each_child(const Walk& walk, const ChunkBox& box, Each&& each) {
        const auto& node = *static_cast<const tree::Node*>(walk.item);
        const int shift = (walk.level - 1) * tree::kFanBits;
        for (std::size_t slot = 0; slot < node.children.size(); ++slot) {
            if (!node.children[slot]) continue;
            const Walk child{node.children[slot].get(), walk.level - 1, walk.quadrant,
                             walk.u0 + (std::uint64_t{slot & (tree::kFan - 1)} << shift),
                             walk.v0 + (std::uint64_t{slot >> tree::kFanBits} << shift)};
            if (child.box().intersects(box)) each(child);
        }
    }

    template <class Visit>
    static void descend(const Walk& walk, const ChunkBox& box, Revision since, Visit& visit) {
        if (walk.item->revision <= since) return;
        if (walk.level == 0) {
            const ChunkBox at = walk.box();
            visit(ChunkKey{static_cast<std::int32_t>(at.cj_begin), static_cast<std::int32_t>(at.ci_begin)},
                  *static_cast<const ChunkType*>(walk.item));
            return;
        }
        for_each_child(walk, box, [&](const Walk& child) { descend(child, box, since, visit); });
    }

    static void newest_below(const Walk& walk, const ChunkBox& box, Revision& newest) {
        if (walk.item->revision <= newest) return;
        if (walk.level == 0 || box.contains(walk.box())) {
            newest = walk.item->revision;
            return;
        }
        for_each_child(walk, box, [&](const Walk& child) { newest_below(child, box, newest); });
    }

    tree::Quadrants quadrants_;
};

/// An unbounded map from ChunkKey to chunks with cheap immutable snapshots: a persistent radix tree.
///
/// Chunks and nodes are shared with the snapshots that hold them. An item is copied before it is written if it is
/// shared, i.e. if anything on the path from the root to it has another holder. A snapshot therefore costs four
/// pointers, and a write after it one copy per changed chunk; once the snapshot is released, writes copy nothing.
/// Threads: one writer; any number of threads may read, copy and release snapshots at the same time.
/// Source: Driscoll, Sarnak, Sleator, Tarjan, Making Data Structures Persistent (1989): path copying.
template <class ChunkType>
class ChunkTree {
public:
    /// Creates a tree without chunks.
    /// @param blank  the contents of a chunk before its first write; trees of the same kind share it
    explicit ChunkTree(std::shared_ptr<const ChunkType> blank) : blank_(std::move(blank)) {}
    ChunkTree(ChunkTree&&) noexcept = default;
    ChunkTree& operator=(ChunkTree&&) noexcept = default;
    ~ChunkTree() = default;

    /// Returns the chunk for writing at `revision`; creates it if it does not exist.
    /// The reference is valid until the next snapshot() or branch().
    /// @param key       any chunk
    /// @param revision  of the change; not less than that of earlier writes
    [[nodiscard]] ChunkType& write(ChunkKey key, Revision revision) {
        auto& quadrant = quadrants_[tree::quadrant_of(key)];
        const std::uint32_t u = tree::away_from_origin(key.ci);
        const std::uint32_t v = tree::away_from_origin(key.cj);
        grow(quadrant, u | v);
        tree::Node* node = own(quadrant.root, revision);
        for (int level = quadrant.height; level > 1; --level) {
            node = own_as<tree::Node>(node->children[tree::slot_of(u, v, level)], revision);
        }
        return *own_as<ChunkType>(node->children[tree::slot_of(u, v, 1)], revision);
    }

    /// Returns the current chunk, or nullptr if it was never written. The pointer is valid until the next write.
    /// @param key  any chunk
    [[nodiscard]] const ChunkType* find(ChunkKey key) const noexcept {
        return static_cast<const ChunkType*>(tree::find(quadrants_, key));
    }

    /// Returns a second tree with the same contents and its own writer. Each tree copies shared chunks before it writes
    /// them.
    [[nodiscard]] ChunkTree branch() {
        ChunkTree other(*this); // copied_ is kept: it may be too high, but never too low
        other.copied_ = 0;
        return other;
    }

    /// Returns the contents of a chunk before its first write.
    [[nodiscard]] const ChunkType& blank() const noexcept { return *blank_; }

    /// Returns the number of chunks.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Returns how many chunks of the last snapshot have been copied since, or a few more if the tree was branched.
    /// While that snapshot is held, at most that many chunks exist in addition to size().
    [[nodiscard]] std::size_t copied() const noexcept { return copied_; }

    /// Returns the current contents for the writer to read until its next write.
    [[nodiscard]] ChunkView<ChunkType> peek() const { return ChunkView<ChunkType>(quadrants_); }

    /// Returns the current contents. Later writes do not change the snapshot.
    [[nodiscard]] ChunkView<ChunkType> snapshot() {
        copied_ = 0;
        return ChunkView<ChunkType>(quadrants_);
    }

private:
    ChunkTree(const ChunkTree&) = default; // for branch() alone

    void grow(tree::Quadrant& quadrant, std::uint32_t reach) {
        if (!quadrant.root) {
            quadrant.root = ItemRef<tree::Node>::of_new(new tree::Node);
            quadrant.height = 1;
        }
        while (!tree::reaches(quadrant.height, reach)) {
            auto root = ItemRef<tree::Node>::of_new(new tree::Node);
            root->revision = quadrant.root->revision;
            root->children[0] = std::move(quadrant.root);
            quadrant.root = std::move(root);
            ++quadrant.height;
        }
    }

    /// Returns the node for writing, copied first if it is shared.
    /// Precondition, also of own_as(): whatever contains the reference has one holder only. A sole holder of the item
    /// then is the only access to it.
    tree::Node* own(ItemRef<tree::Node>& node, Revision revision) {
        if (node.is_shared()) node = ItemRef<tree::Node>::of_new(new tree::Node(*node.get()));
        node->revision = std::max(node->revision, revision);
        return node.get();
    }

    template <class Item>
    Item* own_as(ItemRef<TreeItem>& child, Revision revision) {
        if (!child) {
            child = made<Item>();
        } else if (child.is_shared()) {
            child = ItemRef<Item>::of_new(new Item(*static_cast<const Item*>(child.get())));
            if constexpr (!std::is_same_v<Item, tree::Node>) ++copied_;
        }
        child->revision = std::max(child->revision, revision);
        return static_cast<Item*>(child.get());
    }

    template <class Item>
    ItemRef<Item> made() {
        if constexpr (std::is_same_v<Item, tree::Node>) {
            return ItemRef<Item>::of_new(new tree::Node);
        } else {
            auto chunk = ItemRef<Item>::of_new(new ChunkType(*blank_));
            ++size_;
            return chunk;
        }
    }

    tree::Quadrants quadrants_;
    std::size_t size_ = 0;
    std::size_t copied_ = 0;
    std::shared_ptr<const ChunkType> blank_;
};

} // namespace scanloom::grid
