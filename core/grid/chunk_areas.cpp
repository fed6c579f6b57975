#include "core/grid/chunk_areas.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::grid {
namespace {

bool overlap(const CellBox& a, const CellBox& b) {
    return a.i_begin < b.i_end && b.i_begin < a.i_end && a.j_begin < b.j_end && b.j_begin < a.j_end;
}

} // namespace

CellBox box_of(ChunkKey key) noexcept {
    return {key.ci * kChunkSide, key.cj * kChunkSide, (key.ci + 1) * kChunkSide, (key.cj + 1) * kChunkSide};
}

CellBox grown(const CellBox& box, std::int32_t chunks) noexcept {
    const std::int32_t cells = chunks * kChunkSide;
    return {box.i_begin - cells, box.j_begin - cells, box.i_end + cells, box.j_end + cells};
}

ChunkAreas::ChunkAreas(std::vector<ChunkKey> chunks, std::int32_t reach)
    : reach_(reach), chunks_(std::move(chunks)), taken_(chunks_.size()) {
    std::ranges::sort(chunks_);
}

void ChunkAreas::take_all(CellBox& box) {
    for (const ChunkKey key : chunks_) box.include(box_of(key));
    taken_.assign(chunks_.size(), true);
    taken_count_ = static_cast<std::int64_t>(chunks_.size());
}

void ChunkAreas::take_around(ChunkKey key, CellBox& box) {
    take_neighbours(key, box);
    while (!open_.empty()) {
        const ChunkKey next = open_.back();
        open_.pop_back();
        take_neighbours(next, box);
    }
}

void ChunkAreas::take_touched(CellBox& box) {
    for (bool grew = true; grew;) {
        grew = false;
        const CellBox near = grown(box, 1 + reach_);
        for (std::size_t n = 0; n < chunks_.size(); ++n) {
            if (taken_[n] || !overlap(box_of(chunks_[n]), near)) continue;
            take_around(chunks_[n], box);
            grew = true;
        }
    }
    box = grown(box, 1);
}

void ChunkAreas::take_neighbours(ChunkKey key, CellBox& box) {
    for (std::int32_t cj = key.cj - reach_; cj <= key.cj + reach_; ++cj) {
        const ChunkKey first{.cj = cj, .ci = key.ci - reach_};
        const ChunkKey last{.cj = cj, .ci = key.ci + reach_};
        for (auto found = std::ranges::lower_bound(chunks_, first); found != chunks_.end() && *found <= last; ++found) {
            const auto place = static_cast<std::size_t>(found - chunks_.begin());
            if (taken_[place]) continue;
            taken_[place] = true;
            ++taken_count_;
            box.include(box_of(*found));
            open_.push_back(*found);
        }
    }
}

} // namespace scanloom::grid
