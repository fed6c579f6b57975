#include "server/tiles/difference.hpp"

#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/tiles/png.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace scanloom::tiles {
namespace {

/// A cell value of any layer, so that one table type serves all layers.
using Value = std::int16_t;
constexpr Value kNoValue = mapping::kUnknownLogOdds;
constexpr std::size_t kValues = 65536;

Value value_of(mapping::LogOdds cell) noexcept { return cell; }
Value value_of(mapping::HimmCount cell) noexcept { return mapping::is_known(cell) ? Value{cell} : kNoValue; }
Value value_of(classify::CellClass cell) noexcept {
    const bool is_known = cell != classify::CellClass::kUnexplored && cell != classify::CellClass::kFrontier;
    return is_known ? static_cast<Value>(cell) : kNoValue;
}

enum class Verdict : std::uint8_t { kUnknown, kFree, kOccupied, kUndecided };

/// A value is occupied at `occupied` or above and free at `free` or below.
struct Thresholds {
    int free;
    int occupied;
};

Thresholds thresholds_of(mapping::Layer layer, const mapping::MapConfig& config) {
    const auto fixed = [](double p) {
        constexpr double kMost = std::numeric_limits<Value>::max();
        return static_cast<int>(
            std::lround(std::clamp(mapping::log_odds_of(p) * mapping::kLogOddsScale, -kMost, kMost)));
    };
    switch (layer) {
    case mapping::Layer::kHimm: return {config.class_himm_free, config.class_himm_occupied};
    case mapping::Layer::kOccupancy:
    case mapping::Layer::kSonar: return {fixed(config.class_p_free), fixed(config.class_p_occupied)};
    case mapping::Layer::kClassification: return {}; // has no thresholds
    }
    std::abort(); // each layer has a case
}

Verdict verdict_of(mapping::Layer layer, Value value, const Thresholds& thresholds) {
    if (value == kNoValue) return Verdict::kUnknown;
    if (layer == mapping::Layer::kClassification) {
        return static_cast<classify::CellClass>(value) == classify::CellClass::kOccupied ? Verdict::kOccupied
                                                                                         : Verdict::kFree;
    }
    if (value >= thresholds.occupied) return Verdict::kOccupied;
    return value <= thresholds.free ? Verdict::kFree : Verdict::kUndecided;
}

template <class Cell>
Cell at(const std::vector<Cell>& table, Value value) noexcept {
    return table[static_cast<std::uint16_t>(value)];
}

/// Returns the verdict of every value, indexed by the value's bits as uint16.
std::vector<Verdict> verdicts_of(mapping::Layer layer, const mapping::MapConfig& config) {
    const auto thresholds = thresholds_of(layer, config);
    std::vector<Verdict> verdicts(kValues);
    for (std::size_t bits = 0; bits < kValues; ++bits) {
        verdicts[bits] = verdict_of(layer, static_cast<Value>(bits), thresholds);
    }
    return verdicts;
}

/// Returns the probability of every value, indexed by the value's bits as uint16; 0 for layers without probabilities.
std::vector<double> probabilities_of(mapping::Layer layer) {
    std::vector<double> probabilities(kValues, 0.0);
    if (!mapping::is_probability(layer)) return probabilities;
    for (std::size_t bits = 0; bits < kValues; ++bits) {
        probabilities[bits] = mapping::probability_of(static_cast<Value>(bits));
    }
    return probabilities;
}

Difference difference_of(Verdict a, Verdict b) {
    if (a == Verdict::kUnknown) return b == Verdict::kUnknown ? Difference::kNeither : Difference::kOnlyB;
    if (b == Verdict::kUnknown) return Difference::kOnlyA;
    if (a == Verdict::kUndecided || b == Verdict::kUndecided) return Difference::kUndecided;
    if (a == b) return a == Verdict::kFree ? Difference::kBothFree : Difference::kBothOccupied;
    return a == Verdict::kFree ? Difference::kFreeOccupied : Difference::kOccupiedFree;
}

/// The rows of a map sampled at the places of a frame whose cells are no larger than the map's.
class RowsUnder {
public:
    RowsUnder(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame)
        : snapshot_(snapshot), layer_(layer), frame_cell_(frame.cell_size), columns_(frame.pixels_wide()),
          row_(columns_.size(), kNoValue) {
        for (std::size_t n = 0; n < columns_.size(); ++n) {
            columns_[n] = own_index(frame.cells.i_begin + static_cast<std::int32_t>(n));
        }
    }

    /// Returns the values of a frame's row. Valid until the next call.
    [[nodiscard]] std::span<const Value> row(std::int32_t j) {
        const std::int32_t own = own_index(j);
        if (row_j_ != own) {
            mapping::with_layer(snapshot_, layer_,
                                [&](const auto& view, auto&& cells_of) { read(own, view, cells_of); });
        }
        row_j_ = own;
        return row_;
    }

private:
    /// Returns the index of the map's cell that contains the centre of a place.
    [[nodiscard]] std::int32_t own_index(std::int32_t index) const {
        constexpr double kSnapCells = 1e-6; // a centre on a border belongs to the cell after it
        if (snapshot_.config.cell_size == frame_cell_) return index;
        return static_cast<std::int32_t>(
            std::floor((index + 0.5) * (frame_cell_ / snapshot_.config.cell_size) + kSnapCells));
    }

    template <class View, class CellsOf>
    void read(std::int32_t j, const View& view, CellsOf&& cells_of) {
        for (std::size_t n = 0; n < columns_.size();) {
            const auto key = grid::chunk_of({columns_[n], j});
            const auto* chunk = view.find(key);
            for (; n < columns_.size() && columns_[n] >> grid::kChunkBits == key.ci; ++n) {
                row_[n] =
                    chunk == nullptr ? kNoValue : value_of(cells_of(*chunk)[grid::index_in_chunk({columns_[n], j})]);
            }
        }
    }

    const mapping::Snapshot& snapshot_;
    mapping::Layer layer_;
    double frame_cell_;
    std::vector<std::int32_t> columns_; // the map's column for each place of a row
    std::vector<Value> row_;
    std::optional<std::int32_t> row_j_; // the map's row in row_
};

/// Precondition: the cells of neither map are smaller than cell_size.
Result<grid::CellBox> places_of(const mapping::Snapshot& snapshot, mapping::Layer layer, double cell_size) {
    const auto cells = mapping::bounds_of(snapshot, layer);
    if (cells.empty() || snapshot.config.cell_size == cell_size) return cells;
    return cells_in(extent_of(cells, snapshot.config.cell_size), cell_size);
}

constexpr std::array<PaletteEntry, kDifferenceNames.size()> kDifferencePalette = {{
    {{255, 255, 255}, 0}, // unknown in both
    {{166, 206, 235}},    // known in A only
    {{252, 214, 148}},    // known in B only
    {{240, 240, 240}},    // both free
    {{140, 140, 140}},    // both occupied
    {{213, 94, 0}},       // obstacle in B
    {{0, 114, 178}},      // obstacle in A
    {{205, 205, 205}},    // undecided
}};

} // namespace

Result<MapFrame> difference_frame(const ComparedMaps& maps, const std::optional<Extent>& bbox,
                                  std::int64_t bytes_per_pixel) {
    const double cell_size = std::min(maps.a.config.cell_size, maps.b.config.cell_size);
    if (bbox) {
        const auto cells = cells_in(*bbox, cell_size);
        if (!cells) return cells.error();
        return checked_frame({*cells, cell_size}, bytes_per_pixel);
    }
    MapFrame frame{{}, cell_size};
    for (const auto* map : {&maps.a, &maps.b}) {
        const auto places = places_of(*map, maps.layer, cell_size);
        if (!places) return Error{Errc::kTooLarge, places.error().message};
        frame.cells.include(*places);
    }
    return checked_frame(frame, bytes_per_pixel);
}

DifferenceSums compare(const ComparedMaps& maps, const MapFrame& frame, const UseDifferences& use) {
    const auto verdicts_a = verdicts_of(maps.layer, maps.a.config);
    const auto verdicts_b = verdicts_of(maps.layer, maps.b.config);
    const auto probabilities = probabilities_of(maps.layer);
    RowsUnder rows_a(maps.a, maps.layer, frame);
    RowsUnder rows_b(maps.b, maps.layer, frame);
    std::vector<Difference> differences(frame.pixels_wide());
    DifferenceSums sums;
    for (std::int32_t j = frame.cells.j_end - 1; j >= frame.cells.j_begin; --j) {
        const auto a = rows_a.row(j);
        const auto b = rows_b.row(j);
        for (std::size_t n = 0; n < differences.size(); ++n) {
            const Verdict verdict_a = at(verdicts_a, a[n]);
            const Verdict verdict_b = at(verdicts_b, b[n]);
            differences[n] = difference_of(verdict_a, verdict_b);
            ++sums.cells[static_cast<std::size_t>(differences[n])];
            if (verdict_a == Verdict::kUnknown || verdict_b == Verdict::kUnknown) continue;
            ++sums.known;
            sums.agreeing += verdict_a == verdict_b ? 1 : 0;
            sums.difference += std::abs(at(probabilities, a[n]) - at(probabilities, b[n]));
        }
        if (use) use(differences);
    }
    return sums;
}

Bytes difference_png(const ComparedMaps& maps, const MapFrame& frame) {
    PngWriter png(frame.width(), frame.height(), kDifferencePalette);
    std::vector<std::uint8_t> pixels(frame.pixels_wide());
    compare(maps, frame, [&](std::span<const Difference> row) {
        std::ranges::transform(row, pixels.begin(), [](Difference d) { return static_cast<std::uint8_t>(d); });
        png.add_row(pixels);
    });
    return png.finish();
}

} // namespace scanloom::tiles
