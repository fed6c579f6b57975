#include "server/planning/search_window.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace scanloom::planning {
namespace {

using classify::ClassChunk;
using classify::ClassView;
using grid::CellBox;
using grid::ChunkKey;

constexpr std::int64_t kChunkCells = std::int64_t{grid::kChunkSide} * grid::kChunkSide;

/// Chunks that the largest body (kBodyRadiusMax) touches besides its own on the smallest cells (1 cm), and some more.
constexpr std::int32_t kReachMax = 16;

/// Chunks whose cells, and those of chunks within reach of them, have int32 numbers.
constexpr std::int64_t kChunkEnd =
    std::int64_t{std::numeric_limits<std::int32_t>::max()} / grid::kChunkSide - kReachMax - 1;
constexpr grid::ChunkBox kNumberedChunks{-kChunkEnd, -kChunkEnd, kChunkEnd, kChunkEnd};

CellBox box_of(ChunkKey key) {
    return {key.ci * grid::kChunkSide, key.cj * grid::kChunkSide, (key.ci + 1) * grid::kChunkSide,
            (key.cj + 1) * grid::kChunkSide};
}

CellBox grown(const CellBox& box, std::int32_t chunks) {
    const std::int32_t cells = chunks * grid::kChunkSide;
    return {box.i_begin - cells, box.j_begin - cells, box.i_end + cells, box.j_end + cells};
}

bool overlap(const CellBox& a, const CellBox& b) {
    return a.i_begin < b.i_end && b.i_begin < a.i_end && a.j_begin < b.j_end && b.j_begin < a.j_end;
}

/// Explored chunks; each is taken once, with its whole area.
class Areas {
public:
    /// @param reach  from a chunk to others of its area, in chunks
    Areas(const ClassView& classes, std::int32_t reach) : reach_(reach) {
        classes.visit(kNumberedChunks, 0, [&](ChunkKey key, const ClassChunk&) { chunks_.push_back(key); });
        std::ranges::sort(chunks_);
        taken_.resize(chunks_.size());
    }

    [[nodiscard]] std::int64_t taken_cells() const { return std::ranges::count(taken_, true) * kChunkCells; }

    void take_all(CellBox& window) {
        for (const ChunkKey key : chunks_) window.include(box_of(key));
        taken_.assign(chunks_.size(), true);
    }

    void take_around(ChunkKey key, CellBox& window) {
        take_neighbours(key, window);
        while (!open_.empty()) {
            const ChunkKey next = open_.back();
            open_.pop_back();
            take_neighbours(next, window);
        }
    }

    /// Grows the window by a chunk on every side, with whatever area would come within reach of it.
    void take_touched(CellBox& window) {
        for (bool grew = true; grew;) {
            grew = false;
            const CellBox near = grown(window, 1 + reach_);
            for (std::size_t n = 0; n < chunks_.size(); ++n) {
                if (taken_[n] || !overlap(box_of(chunks_[n]), near)) continue;
                take_around(chunks_[n], window);
                grew = true;
            }
        }
        window = grown(window, 1);
    }

private:
    void take_neighbours(ChunkKey key, CellBox& window) {
        for (std::int32_t cj = key.cj - reach_; cj <= key.cj + reach_; ++cj) {
            const ChunkKey first{.cj = cj, .ci = key.ci - reach_};
            const ChunkKey last{.cj = cj, .ci = key.ci + reach_};
            for (auto found = std::ranges::lower_bound(chunks_, first); found != chunks_.end() && *found <= last;
                 ++found) {
                const auto place = static_cast<std::size_t>(found - chunks_.begin());
                if (taken_[place]) continue;
                taken_[place] = true;
                window.include(box_of(*found));
                open_.push_back(*found);
            }
        }
    }

    std::int32_t reach_;
    std::vector<ChunkKey> chunks_; // sorted
    std::vector<bool> taken_;
    std::vector<ChunkKey> open_; // taken, but not their neighbours yet
};

} // namespace

Result<grid::Cell> numbered_cell(const Point2& point, double cell_size_m) {
    const double cells_per_metre = 1.0 / cell_size_m;
    const double i = std::floor(point.x * cells_per_metre);
    const double j = std::floor(point.y * cells_per_metre);
    const auto end = static_cast<double>(kChunkEnd * grid::kChunkSide);
    if (!(std::abs(i) < end && std::abs(j) < end)) { // also when it is NaN
        return Error{Errc::kInvalidField, fmt::format("the point ({}, {}) has no cell in any map", point.x, point.y)};
    }
    return grid::Cell{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)};
}

Result<SearchWindow> search_window(const ClassView& classes, double cell_size_m, const Reach& reach,
                                   std::span<const Point2> ends) {
    std::vector<ChunkKey> chunks_of_ends;
    for (const Point2& end : ends) {
        const auto cell = numbered_cell(end, cell_size_m);
        if (!cell) return cell.error();
        chunks_of_ends.push_back(grid::chunk_of(*cell));
    }
    // Cells of chunks with n others between them are more than n chunks apart.
    Areas areas(classes, 1 + static_cast<std::int32_t>((reach.body_radius_m / cell_size_m + 2.0) / grid::kChunkSide));
    CellBox window;
    if (ends.empty()) {
        areas.take_all(window);
        if (reach.allow_unknown && !window.empty()) window = grown(window, 1);
    } else if (!reach.allow_unknown) {
        areas.take_around(chunks_of_ends.front(), window);
    } else {
        for (const ChunkKey key : chunks_of_ends) {
            window.include(box_of(key));
            areas.take_around(key, window);
        }
        areas.take_touched(window);
    }
    if (window.empty()) return SearchWindow{{0, 0, 0, 0}, 0};
    if (window.width() > kWindowCellsMax / window.height()) {
        return Error{
            Errc::kTooLarge,
            fmt::format("planning needs a window of {} x {} cells, more than {}: plan on a map of larger cells",
                        window.width(), window.height(), kWindowCellsMax)};
    }
    const std::int64_t cells = reach.allow_unknown ? window.width() * window.height() : areas.taken_cells();
    if (cells <= kSearchCellsMax) return SearchWindow{window, cells};
    return Error{Errc::kTooLarge,
                 fmt::format("planning needs a search of {} {}cells, more than {}: plan on a map of larger cells",
                             cells, reach.allow_unknown ? "" : "explored ", kSearchCellsMax)};
}

} // namespace scanloom::planning
