#pragma once

#include "core/grid/cell.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>

namespace scanloom::oracle {

/// An unbounded plane of cells, blank until written. Stored in blocks, so that only blocks in use take memory.
template <class Value>
class Plane {
public:
    explicit Plane(Value blank) : blank_(blank) {}

    [[nodiscard]] Value& operator[](grid::Cell cell) {
        box_.include_row(cell.j, cell.i, cell.i + 1);
        auto& block = blocks_[block_of(cell)];
        if (!block) {
            block = std::make_unique<Block>();
            block->fill(blank_);
        }
        return (*block)[place_of(cell)];
    }

    [[nodiscard]] const Value& at(grid::Cell cell) const {
        if (const auto wanted = block_of(cell); !has_last_ || wanted != last_) {
            const auto found = blocks_.find(wanted);
            last_ = wanted;
            last_block_ = found == blocks_.end() ? nullptr : found->second.get();
            has_last_ = last_block_ != nullptr;
        }
        return last_block_ == nullptr ? blank_ : (*last_block_)[place_of(cell)];
    }

    /// Calls visit(Cell, const Value&) for the cells of the smallest box that holds all written cells, extended by
    /// `margin` cells on each side.
    template <class Visit>
    void for_each(std::int32_t margin, Visit&& visit) const {
        if (box_.empty()) return;
        for (std::int32_t j = box_.j_begin - margin; j < box_.j_end + margin; ++j) {
            for (std::int32_t i = box_.i_begin - margin; i < box_.i_end + margin; ++i) {
                visit(grid::Cell{i, j}, at({i, j}));
            }
        }
    }

private:
    static constexpr std::int32_t kSide = 128;
    using Block = std::array<Value, std::size_t{kSide} * kSide>;

    [[nodiscard]] static std::int32_t floored(std::int32_t n) { return n < 0 ? -1 - (-1 - n) / kSide : n / kSide; }
    [[nodiscard]] static std::uint64_t block_of(grid::Cell cell) {
        return std::uint64_t{static_cast<std::uint32_t>(floored(cell.j))} << 32 |
               static_cast<std::uint32_t>(floored(cell.i));
    }
    [[nodiscard]] static std::size_t place_of(grid::Cell cell) {
        const auto within = [](std::int32_t n) { return static_cast<std::size_t>(n - floored(n) * kSide); };
        return within(cell.j) * kSide + within(cell.i);
    }

    Value blank_;
    std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
    grid::CellBox box_;
    mutable bool has_last_ = false; // the last block used; neighbouring cells are mostly in the same block
    mutable std::uint64_t last_ = 0;
    mutable const Block* last_block_ = nullptr;
};

} // namespace scanloom::oracle
