#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::mapping {

inline constexpr std::size_t kListBlock = 512; ///< items

namespace detail {
template <class Item>
using ListBlock = std::array<Item, kListBlock>;
template <class Item>
using ListBlocks = std::vector<std::shared_ptr<ListBlock<Item>>>;
} // namespace detail

/// The items of a GrowingList at one moment. Immutable, cheap to copy. Items before begin() are not kept.
/// Threads: any number of readers, while the writer appends items after those in the view.
template <class Item>
class ListView {
public:
    ListView() = default;
    /// Creates a view of the blocks of a list. Obtain views from GrowingList::snapshot() instead.
    ListView(std::shared_ptr<const detail::ListBlocks<Item>> blocks, std::size_t begin, std::size_t size)
        : blocks_(std::move(blocks)), begin_(begin), size_(size) {}

    /// Returns the index of the first item that is kept; size() if none is.
    [[nodiscard]] std::size_t begin() const noexcept { return begin_; }

    /// Returns the number of items, including those no longer kept.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Returns the item with this index.
    /// @param index  from 0
    /// Precondition: begin() <= index < size().
    [[nodiscard]] const Item& operator[](std::size_t index) const noexcept {
        return (*(*blocks_)[(index - begin_) / kListBlock])[(index - begin_) % kListBlock];
    }

private:
    std::shared_ptr<const detail::ListBlocks<Item>> blocks_;
    std::size_t begin_ = 0;
    std::size_t size_ = 0;
};

/// A growing list with cheap snapshots.
///
/// Items never move once written, and views hold the blocks that they were taken with. Branches share their blocks. A
/// branch copies the last block before it appends to it.
/// Threads: one writer.
template <class Item>
class GrowingList {
public:
    static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max(); ///< items

    /// @param before  number of earlier items, which are not kept
    /// @param kept    number of newest items that are kept at least
    explicit GrowingList(std::size_t before = 0, std::size_t kept = kAll)
        : kept_(kept), begin_(before), size_(before) {}

    GrowingList(GrowingList&&) noexcept = default;
    GrowingList& operator=(GrowingList&&) noexcept = default;
    ~GrowingList() = default;

    /// Adds an item.
    void append(const Item& item) {
        if (!owns_last_) own_last();
        if (in_last() == 0) begin_block();
        (*blocks_->back())[in_last()] = item;
        ++size_;
    }

    /// Returns the number of blocks that are kept.
    [[nodiscard]] std::size_t block_count() const noexcept { return blocks_->size(); }

    /// Returns the current items. Items appended later are not in the view.
    [[nodiscard]] ListView<Item> snapshot() const { return {blocks_, begin_, size_}; }

    /// Returns a second list with the same items and its own writer.
    [[nodiscard]] GrowingList branch() const {
        GrowingList other(*this);
        other.owns_last_ = false;
        return other;
    }

private:
    using Block = detail::ListBlock<Item>;
    using Blocks = detail::ListBlocks<Item>;

    GrowingList(const GrowingList&) = default; // for branch() alone

    /// Returns the number of items in the last block; 0 also if that block is full.
    [[nodiscard]] std::size_t in_last() const noexcept { return (size_ - begin_) % kListBlock; }

    /// Starts a new block. Drops the first block if enough items remain without it.
    void begin_block() {
        const bool enough = size_ - begin_ > kept_;
        auto blocks = std::make_shared<Blocks>(blocks_->begin() + (enough ? 1 : 0), blocks_->end());
        blocks->push_back(std::make_shared<Block>());
        blocks_ = std::move(blocks);
        if (enough) begin_ += kListBlock;
    }

    /// Copies the last block up to size_; another list may be writing after it.
    void own_last() {
        owns_last_ = true;
        const std::size_t count = in_last();
        if (count == 0) return;
        auto blocks = std::make_shared<Blocks>(*blocks_);
        auto last = std::make_shared<Block>();
        std::copy_n(blocks->back()->begin(), count, last->begin());
        blocks->back() = std::move(last);
        blocks_ = std::move(blocks);
    }

    std::shared_ptr<Blocks> blocks_ = std::make_shared<Blocks>();
    std::size_t kept_;
    std::size_t begin_; // index of the first block's first item
    std::size_t size_;
    bool owns_last_ = true; // whether this list alone writes to the last block
};

} // namespace scanloom::mapping
