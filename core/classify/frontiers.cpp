#include "core/classify/frontiers.hpp"

#include "core/classify/bit_plane.hpp"

#include <boost/iterator/counting_iterator.hpp>
#include <boost/pending/disjoint_sets.hpp>

#include <algorithm>
#include <compare>
#include <cstring>
#include <functional>
#include <limits>

namespace scanloom::classify {
namespace {

/// Adjacent frontier cells of one row.
struct Run {
    std::int32_t j;
    std::int32_t i_begin;
    std::int32_t i_end;

    friend auto operator<=>(const Run&, const Run&) = default;
};

/// The chunks whose cells, and the adjacent cells, have int32 indices.
constexpr grid::ChunkBox numbered_chunks() {
    constexpr std::int64_t kEnd = std::int64_t{std::numeric_limits<std::int32_t>::max()} / grid::kChunkSide;
    return {-kEnd, -kEnd, kEnd, kEnd};
}

bool has_frontier(const ClassChunk& chunk) {
    return std::memchr(chunk.cells.data(), static_cast<int>(CellClass::kFrontier), chunk.cells.size()) != nullptr;
}

void append_runs(std::uint64_t row, std::int32_t i0, std::int32_t j, std::vector<Run>& runs) {
    while (row != 0) {
        const int begin = std::countr_zero(row);
        const int length = std::countr_one(row >> begin);
        runs.push_back({j, i0 + begin, i0 + begin + length});
        if (begin + length == grid::kChunkSide) return;
        row &= ~std::uint64_t{0} << (begin + length);
    }
}

/// Returns all runs of the map, by rows. Runs that the border of a chunk divides are joined.
std::vector<Run> frontier_runs(const ClassView& classes) {
    std::vector<Run> runs;
    classes.visit(numbered_chunks(), 0, [&](grid::ChunkKey key, const ClassChunk& chunk) {
        if (!has_frontier(chunk)) return;
        const BitPlane frontier = bits_where(chunk.cells, CellClass::kFrontier);
        for (std::int32_t j = 0; j < grid::kChunkSide; ++j) {
            append_runs(frontier[static_cast<std::size_t>(j)], key.ci * grid::kChunkSide, key.cj * grid::kChunkSide + j,
                        runs);
        }
    });
    std::ranges::sort(runs);
    std::size_t kept = 0;
    for (const Run& run : runs) {
        if (kept > 0 && runs[kept - 1].j == run.j && runs[kept - 1].i_end == run.i_begin) {
            runs[kept - 1].i_end = run.i_end;
        } else {
            runs[kept++] = run;
        }
    }
    runs.resize(kept);
    return runs;
}

/// Removes cells from the runs and returns the rest.
std::vector<Run> cut_out(const std::vector<Run>& runs, std::span<const grid::Cell> without) {
    if (without.empty()) return runs;
    std::vector<Run> cuts; // one cell each
    for (const grid::Cell cell : without) cuts.push_back({cell.j, cell.i, cell.i + 1});
    std::ranges::sort(cuts);
    std::vector<Run> left;
    auto cut = cuts.begin();
    for (const Run& run : runs) {
        std::int32_t begin = run.i_begin;
        const auto append_up_to = [&](std::int32_t end) {
            if (begin < end) left.push_back({run.j, begin, end});
        };
        while (cut != cuts.end() && *cut < Run{run.j, run.i_begin, run.i_begin}) ++cut;
        for (; cut != cuts.end() && cut->j == run.j && cut->i_begin < run.i_end; ++cut) {
            append_up_to(cut->i_begin);
            begin = cut->i_end;
        }
        append_up_to(run.i_end);
    }
    return left;
}

using Sets = boost::disjoint_sets_with_storage<>;

/// Joins each run with the runs of the row below that it touches, at a corner or along a side.
/// @return sets of connected runs; the first run represents its set
Sets connect(const std::vector<Run>& runs) {
    Sets sets(runs.size());
    std::size_t below = 0;
    for (std::size_t above = 0; above < runs.size(); ++above) {
        const Run& run = runs[above];
        const auto wholly_before = [&](const Run& other) {
            return other.j < run.j - 1 || (other.j == run.j - 1 && other.i_end < run.i_begin);
        };
        while (wholly_before(runs[below])) ++below;
        for (std::size_t other = below; runs[other].j == run.j - 1 && runs[other].i_begin <= run.i_end; ++other) {
            sets.union_set(above, other);
        }
    }
    using Index = boost::counting_iterator<std::size_t>;
    sets.compress_sets(Index(0), Index(runs.size()));
    sets.normalize_sets(Index(0), Index(runs.size()));
    return sets;
}

Frontier to_frontier(const std::vector<Run>& runs) {
    Frontier frontier;
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (const Run& run : runs) {
        frontier.bounds.include_row(run.j, run.i_begin, run.i_end);
        for (std::int32_t i = run.i_begin; i < run.i_end; ++i) frontier.cells.push_back({i, run.j});
        const double length = static_cast<double>(run.i_end - run.i_begin);
        sum_x += length * 0.5 * (static_cast<double>(run.i_begin) + run.i_end);
        sum_y += length * (run.j + 0.5);
    }
    const auto size = static_cast<double>(frontier.cells.size());
    frontier.centroid_x = sum_x / size;
    frontier.centroid_y = sum_y / size;
    return frontier;
}

} // namespace

std::vector<Frontier> find_frontiers(const ClassView& classes, std::size_t size_min,
                                     std::span<const grid::Cell> without) {
    const std::vector<Run> runs = cut_out(frontier_runs(classes), without);
    Sets sets = connect(runs);
    std::vector<std::vector<Run>> groups(runs.size()); // indexed by the first run, which represents its set
    std::vector<std::size_t> sizes(runs.size());
    for (std::size_t run = 0; run < runs.size(); ++run) {
        const std::size_t group = sets.find_set(run);
        groups[group].push_back(runs[run]);
        sizes[group] += static_cast<std::size_t>(runs[run].i_end - runs[run].i_begin);
    }
    std::vector<Frontier> frontiers;
    for (std::size_t group = 0; group < groups.size(); ++group) {
        if (!groups[group].empty() && sizes[group] >= size_min) frontiers.push_back(to_frontier(groups[group]));
    }
    std::ranges::stable_sort(frontiers, std::greater{}, [](const Frontier& f) { return f.cells.size(); });
    return frontiers;
}

} // namespace scanloom::classify
