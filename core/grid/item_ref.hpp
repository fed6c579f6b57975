#pragma once

#include "common/scan/log_entry.hpp"

#include <atomic>
#include <cstdint>
#include <utility>

namespace scanloom::grid {

template <class Item>
class ItemRef;

/// A node or a leaf of a ChunkTree. Counts its holders: trees, snapshots and the nodes above it.
struct TreeItem {
    Revision revision = 0; ///< the newest change in it or below it

    TreeItem() = default;
    /// Copies the revision. The copy has no holders yet.
    TreeItem(const TreeItem& other) noexcept : revision(other.revision) {} // a copy has holders of its own
    /// Copies the revision. Both items keep their holders.
    TreeItem& operator=(const TreeItem& other) noexcept {
        revision = other.revision;
        return *this;
    }
    virtual ~TreeItem() = default;

private:
    template <class Item>
    friend class ItemRef;

    std::atomic<std::uint32_t> holders_ = 0;
};

/// A reference that holds an item. The item is deleted with its last holder.
///
/// Compared with std::shared_ptr, it takes half the space in a node, and is_shared() tells the writer that it is the
/// sole holder, with a guarantee: what other holders read happened before what the writer writes then.
/// Threads: as std::shared_ptr: any thread may change the count; only one thread at a time may use one ItemRef.
template <class Item>
class ItemRef {
public:
    ItemRef() = default;
    /// Becomes another holder of the item.
    ItemRef(const ItemRef& other) noexcept : item_(other.item_) { hold(); }
    /// Takes the item over and leaves `other` empty.
    ItemRef(ItemRef&& other) noexcept : item_(std::exchange(other.item_, nullptr)) {}
    /// Holds the item of `other` instead of its own.
    ItemRef& operator=(ItemRef other) noexcept {
        std::swap(item_, other.item_);
        return *this;
    }
    ~ItemRef() { let_go(); }

    /// Returns the only holder of a new item and takes ownership of it.
    /// @param item  made by new; held by no other reference
    [[nodiscard]] static ItemRef of_new(Item* item) noexcept {
        ItemRef ref;
        ref.item_ = item;
        ref.hold();
        return ref;
    }

    /// Converts to a holder of the base type.
    template <class Base>
    operator ItemRef<Base>() && noexcept { // NOLINT(google-explicit-constructor): as of pointers
        ItemRef<Base> ref;
        ref.item_ = std::exchange(item_, nullptr);
        return ref;
    }

    /// Returns the item, or nullptr if the reference is empty.
    [[nodiscard]] Item* get() const noexcept { return item_; }
    /// Returns the item. Precondition: the reference is not empty.
    [[nodiscard]] Item* operator->() const noexcept { return item_; }
    /// Returns whether the reference holds an item.
    [[nodiscard]] explicit operator bool() const noexcept { return item_ != nullptr; }

    /// Returns whether the item has another holder. Once false, it remains false until this holder is copied.
    /// Precondition: this reference is not empty.
    [[nodiscard]] bool is_shared() const noexcept { return holders().load(std::memory_order_acquire) != 1; }

private:
    template <class Other>
    friend class ItemRef;

    [[nodiscard]] std::atomic<std::uint32_t>& holders() const noexcept {
        return static_cast<TreeItem*>(item_)->holders_;
    }
    void hold() const noexcept {
        if (item_ != nullptr) holders().fetch_add(1, std::memory_order_relaxed);
    }
    void let_go() const noexcept {
        if (item_ != nullptr && holders().fetch_sub(1, std::memory_order_acq_rel) == 1) delete item_;
    }

    Item* item_ = nullptr;
};

} // namespace scanloom::grid
