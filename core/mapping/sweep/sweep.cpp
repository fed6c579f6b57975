#include "core/mapping/sweep/sweep.hpp"

#include "core/mapping/sweep/fill.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace scanloom::mapping {
namespace {

/// Sectors that meet hold exactly the same direction.
bool meet(const Direction& high, const Direction& low) { return high.x == low.x && high.y == low.y; }

void append(FanRing& ring, std::uint32_t beam, const Direction& low) {
    ring.beams.push_back(beam);
    ring.edges_x.push_back(low.x);
    ring.edges_y.push_back(low.y);
}

} // namespace

FanRing make_fan_ring(const BeamFan& fan) {
    FanRing ring;
    for (std::size_t n = 0; n < fan.size(); ++n) {
        const Direction& next = fan[(n + 1) % fan.size()].low;
        append(ring, fan[n].beam, fan[n].low);
        if (!meet(fan[n].high, next)) append(ring, FanRing::kNoBeam, fan[n].high);
    }
    ring.sectors = ring.beams.size();
    while (ring.in_order < ring.sectors && ring.beams[ring.in_order] == ring.in_order) ++ring.in_order;
    ring.edges_x.push_back(fan.front().low.x);
    ring.edges_y.push_back(fan.front().low.y);
    ring.edges_x.resize(ring.edges_x.size() + kRingPadding);
    ring.edges_y.resize(ring.edges_y.size() + kRingPadding);
    return ring;
}

namespace {

constexpr std::int32_t kStripChunks = 512; ///< keeps the words of all contours in a core's cache

/// Margin around a box, in cells. Rounding could move a crossing nearer to the edge out of the box.
constexpr double kMargin = 1.0;

void grow(std::vector<double>& values, std::size_t size) {
    if (values.size() < size) values.resize(size);
}

std::int32_t floor_cell(double cells) { return static_cast<std::int32_t>(std::floor(cells)); }

} // namespace

/// The bands of one ring: one band, or a wide band around a narrow one.
struct RingRoom {
    simd::Contours contours;
    std::size_t narrow = 0; ///< index of the narrow band
    std::size_t wide = 0;   ///< index of the wide band; equal to `narrow` if there is one band

    std::vector<double> x, y;
    std::array<std::vector<double>, simd::kContoursMax> radius; ///< values start at the second element
    std::array<std::vector<std::uint64_t>, simd::kContoursMax> words;
    std::array<grid::BitPlane, simd::kContoursMax> carry; ///< of the current row of chunks
};

struct Sweep::Room {
    std::vector<std::int32_t> millimetres;
    std::array<RingRoom, kBandsMax> rings;
    std::size_t ring_count = 0;
    bool is_clear = true; ///< no bit of `words` is set
};

namespace {

Sweep::Room& room_of_this_thread() {
    static thread_local Sweep::Room room;
    return room;
}

/// Collects one reading per sector. Readings that exceed int32 are limited to its maximum, which is also a no-return.
void gather(std::span<const RangeMm> ranges, const FanRing& ring, std::vector<std::int32_t>& millimetres) {
    constexpr auto kLongest = static_cast<RangeMm>(std::numeric_limits<std::int32_t>::max());
    if (millimetres.size() < ring.sectors + kRingPadding) millimetres.resize(ring.sectors + kRingPadding);
    for (std::size_t n = 0; n < ring.in_order; ++n) {
        millimetres[n] = static_cast<std::int32_t>(std::min(ranges[n], kLongest));
    }
    for (std::size_t n = ring.in_order; n < ring.sectors; ++n) {
        const std::uint32_t beam = ring.beams[n];
        millimetres[n] = beam == FanRing::kNoBeam ? 0 : static_cast<std::int32_t>(std::min(ranges[beam], kLongest));
    }
}

/// Adds the two contours of a band as the k-th and the l-th of its ring.
void add_contours(RingRoom& room, const FanRing& ring, const Sweep::Scene& scene, double thickness,
                  const std::vector<std::int32_t>& millimetres, std::size_t k, std::size_t l) {
    for (const std::size_t contour : {k, l}) grow(room.radius[contour], ring.sectors + 1 + kRingPadding);
    const simd::RadiusRule rule{scene.readings.range_min, scene.readings.range_max,
                                std::max(thickness, scene.cell_size) / 2.0, 1.0 / scene.cell_size,
                                scene.readings.drop_no_return};
    simd::radii_of(millimetres.data(), ring.sectors, rule, room.radius[k].data() + 1, room.radius[l].data() + 1);
    for (const std::size_t contour : {k, l}) {
        room.radius[contour].front() = room.radius[contour][ring.sectors];
        room.contours.radius[contour] = room.radius[contour].data() + 1;
    }
}

} // namespace

Sweep::Sweep(const Scene& scene, std::span<const Band> bands) : room_(room_of_this_thread()), bands_(bands.size()) {
    assert(!bands.empty() && bands.size() <= kBandsMax);
    take_in(scene, bands);
    lay_out(scene);
}

/// Rotates the edges of each ring and computes its radii.
void Sweep::take_in(const Scene& scene, std::span<const Band> bands) {
    const bool is_one_ring = bands_ == 2 && bands[0].ring == bands[1].ring;
    room_.ring_count = is_one_ring ? 1 : bands_;
    for (std::size_t n = 0; n < room_.ring_count; ++n) {
        RingRoom& room = room_.rings[n];
        const FanRing& ring = *bands[n].ring;
        for (auto* values : {&room.x, &room.y}) grow(*values, ring.sectors + 1 + kRingPadding);
        const simd::Edges edges{room.x.data(), room.y.data()};
        simd::turn_edges(ring, std::cos(scene.T_map_sensor.yaw), std::sin(scene.T_map_sensor.yaw), edges);
        gather(scene.ranges, ring, room_.millimetres);
        room.wide = is_one_ring && bands[1].thickness > bands[0].thickness ? 1 : n;
        room.narrow = is_one_ring ? 1 - room.wide : n;
        room.contours = {edges, ring.sectors, is_one_ring ? std::size_t{4} : std::size_t{2}, {}};
        if (is_one_ring) add_contours(room, ring, scene, bands[room.wide].thickness, room_.millimetres, 0, 3);
        const std::size_t inner = is_one_ring ? 1 : 0;
        add_contours(room, ring, scene, bands[room.narrow].thickness, room_.millimetres, inner, inner + 1);
    }
}

/// Finds the chunks that contain the contours and divides them into strips.
void Sweep::lay_out(const Scene& scene) {
    simd::Box box;
    for (std::size_t n = 0; n < room_.ring_count; ++n) {
        const simd::Box other = simd::box_of(room_.rings[n].contours);
        box = {std::min(box.x_min, other.x_min), std::min(box.y_min, other.y_min), std::max(box.x_max, other.x_max),
               std::max(box.y_max, other.y_max)};
    }
    if (box.x_min == box.x_max && box.y_min == box.y_max) return; // the scan shows nothing
    const double x = scene.T_map_sensor.x * (1.0 / scene.cell_size);
    const double y = scene.T_map_sensor.y * (1.0 / scene.cell_size);
    cell_ = {floor_cell(x), floor_cell(y)};
    x_ = x - cell_.i;
    y_ = y - cell_.j;
    first_ = grid::chunk_of({floor_cell(x + box.x_min - kMargin), floor_cell(y + box.y_min - kMargin)});
    const auto last = grid::chunk_of({floor_cell(x + box.x_max + kMargin), floor_cell(y + box.y_max + kMargin)});
    columns_ = last.ci - first_.ci + 1;
    rows_ = last.cj - first_.cj + 1;
    strip_rows_max_ = std::clamp(kStripChunks / columns_, 1, rows_);
    strips_ = static_cast<std::size_t>((rows_ + strip_rows_max_ - 1) / strip_rows_max_);
}

void Sweep::begin(std::size_t strip) {
    const std::int32_t below = static_cast<std::int32_t>(strip) * strip_rows_max_;
    first_row_ = first_.cj + below;
    strip_rows_ = std::min(strip_rows_max_, rows_ - below);
    const simd::Strip words{x_,
                            y_,
                            first_.ci * grid::kChunkSide - cell_.i,
                            first_row_ * grid::kChunkSide - cell_.j,
                            columns_ * grid::kChunkSide,
                            strip_rows_ * grid::kChunkSide};
    const auto size = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(words.rows);
    if (!room_.is_clear) clear(); // the last visit did not finish
    room_.is_clear = false;
    for (RingRoom& room : std::span(room_.rings).first(room_.ring_count)) {
        simd::Planes planes{};
        for (std::size_t k = 0; k < room.contours.count; ++k) {
            if (room.words[k].size() < size) room.words[k].resize(size);
            planes[k] = room.words[k].data();
        }
        simd::flip_crossings(room.contours, words, planes);
    }
}

void Sweep::clear() {
    for (RingRoom& room : room_.rings) {
        for (auto& words : room.words) std::ranges::fill(words, 0);
    }
}

void Sweep::begin_row() {
    for (RingRoom& room : std::span(room_.rings).first(room_.ring_count)) {
        for (std::size_t k = 0; k < room.contours.count; ++k) room.carry[k].fill(0);
    }
}

bool Sweep::fill(std::int32_t row, std::int32_t column) {
    const auto at = static_cast<std::size_t>(column * strip_rows_ + row) * grid::kChunkSide;
    std::uint64_t rows = 0;
    for (RingRoom& room : std::span(room_.rings).first(room_.ring_count)) {
        simd::ChunkWords words{};
        for (std::size_t k = 0; k < room.contours.count; ++k) {
            words.flipped[k] = room.words[k].data() + at;
            words.carry[k] = room.carry[k].data();
        }
        simd::fill_bands(words, room.contours.count, verdicts_[room.narrow], &verdicts_[room.wide]);
        rows |=
            verdicts_[room.wide].free_rows | verdicts_[room.wide].occupied_rows; // the wide band contains the narrow
    }
    return rows != 0;
}

void Sweep::end() { room_.is_clear = true; }

} // namespace scanloom::mapping
