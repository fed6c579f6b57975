#include "core/planning/distance_field.hpp"

#include "core/planning/search_window.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::planning {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// In distances_in_columns(): the column has no obstacle. Distances are in cells; their squares are exact in 64 bits.
constexpr std::int32_t kNoObstacle = -1;

/// Computes the distance to the nearest obstacle of the same column, upwards and downwards. This is the first pass of
/// the transform, in which all parabolas have height 0 or infinity.
std::vector<std::int32_t> distances_in_columns(const classify::ClassView& classes, const grid::CellBox& window) {
    const auto width = static_cast<std::size_t>(window.width());
    const auto height = static_cast<std::size_t>(window.height());
    std::vector<std::int32_t> distances(width * height, kNoObstacle);
    classes.visit(grid::chunks_of(window), 0, [&](grid::ChunkKey key, const classify::ClassChunk& chunk) {
        const std::int32_t i_begin = std::max(key.ci * grid::kChunkSide, window.i_begin);
        const std::int32_t j_begin = std::max(key.cj * grid::kChunkSide, window.j_begin);
        for (std::int64_t j = j_begin; j < window.j_end && j >> grid::kChunkBits == key.cj; ++j) {
            for (std::int64_t i = i_begin; i < window.i_end && i >> grid::kChunkBits == key.ci; ++i) {
                const grid::Cell cell{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)};
                if (chunk.at(cell) != classify::CellClass::kOccupied) continue;
                distances[static_cast<std::size_t>(j - window.j_begin) * width +
                          static_cast<std::size_t>(i - window.i_begin)] = 0;
            }
        }
    });
    const auto spread = [&](std::size_t from, std::size_t to) { // row by row, for the cache
        for (std::size_t x = 0; x < width; ++x) {
            const std::int32_t here = distances[from * width + x];
            std::int32_t& there = distances[to * width + x];
            if (here != kNoObstacle && (there == kNoObstacle || there > here + 1)) there = here + 1;
        }
    };
    for (std::size_t y = 1; y < height; ++y) spread(y - 1, y);
    for (std::size_t y = height; y-- > 1;) spread(y, y - 1);
    return distances;
}

/// The second pass, along a row: the lower envelope of the parabolas that stand on the columns' distances.
class Envelope {
public:
    explicit Envelope(std::size_t width) { parabolas_.reserve(width); }

    void fit(std::span<const std::int32_t> column_distances) {
        parabolas_.clear();
        for (std::size_t x = 0; x < column_distances.size(); ++x) {
            if (column_distances[x] == kNoObstacle) continue;
            const auto distance = std::int64_t{column_distances[x]};
            Parabola parabola{static_cast<std::int64_t>(x), distance * distance, 0};
            while (!parabolas_.empty()) {
                parabola.lowest_from = first_below(parabola, parabolas_.back());
                if (parabola.lowest_from > parabolas_.back().lowest_from) break;
                parabolas_.pop_back();
            }
            if (parabolas_.empty()) parabola.lowest_from = 0;
            parabolas_.push_back(parabola);
        }
    }

    void measure(double cell_size_m, std::span<float> metres) const {
        if (parabolas_.empty()) return;
        std::size_t lowest = 0;
        for (std::size_t place = 0; place < metres.size(); ++place) {
            const auto x = static_cast<std::int64_t>(place);
            while (lowest + 1 < parabolas_.size() && parabolas_[lowest + 1].lowest_from <= x) ++lowest;
            const std::int64_t dx = x - parabolas_[lowest].x;
            metres[place] =
                static_cast<float>(std::sqrt(static_cast<double>(dx * dx + parabolas_[lowest].height)) * cell_size_m);
        }
    }

private:
    struct Parabola {
        std::int64_t x;
        std::int64_t height;
        std::int64_t lowest_from; // the first column in which no parabola further left is lower
    };

    /// Returns the first column >= 0 in which `right` is not above `left`. Uses integers, so that rounding cannot
    /// select a wrong parabola.
    static std::int64_t first_below(const Parabola& right, const Parabola& left) {
        const std::int64_t above = right.height + right.x * right.x - left.height - left.x * left.x;
        const std::int64_t twice_apart = 2 * (right.x - left.x);
        return above <= 0 ? 0 : (above + twice_apart - 1) / twice_apart;
    }

    std::vector<Parabola> parabolas_;
};

} // namespace

Result<DistanceField> distance_field(const classify::ClassView& classes, double cell_size_m,
                                     const grid::CellBox& window) {
    if (window.empty()) return DistanceField{window, {}};
    if (window.width() > kSearchCellsMax / window.height()) {
        return Error{Errc::kTooLarge, fmt::format("the window has {} x {} cells, more than {}: ask for a smaller one",
                                                  window.width(), window.height(), kSearchCellsMax)};
    }
    const auto distances = distances_in_columns(classes, window);
    const auto width = static_cast<std::size_t>(window.width());
    DistanceField field{window, std::vector<float>(distances.size(), kNone)};
    Envelope envelope(width);
    for (std::size_t row = 0; row < distances.size(); row += width) {
        envelope.fit({distances.data() + row, width});
        envelope.measure(cell_size_m, {field.metres.data() + row, width});
    }
    return field;
}

} // namespace scanloom::planning
