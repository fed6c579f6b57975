#include "tests/bench/projection/peers.hpp"

#include "core/mapping/sweep/sweep.hpp"
#include "tests/bench/projection/flat_map.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace scanloom::bench {
namespace {

constexpr float kFree = -2.197F;
constexpr float kOccupied = 2.197F;
constexpr float kClamp = 6.907F;

class Bresenham final : public Mapper {
public:
    explicit Bresenham(const Column& column)
        : beam_ends_(column.sensor), map_(column.half_side, column.cell_size, 0.0F) {}

    void insert(const Scan& scan) override {
        const auto& ends = beam_ends_.of(scan);
        const int i = map_.index_of(scan.pose->x);
        const int j = map_.index_of(scan.pose->y);
        const auto add = [&](std::size_t at, float amount) {
            map_.cells[at] = std::clamp(map_.cells[at] + amount, -kClamp, kClamp);
        };
        for (const BeamEnd& end : ends) {
            const int i_end = map_.index_of(end.x);
            const int j_end = map_.index_of(end.y);
            for_each_on_line(i, j, i_end, j_end, map_.side, [&](std::size_t at) { add(at, kFree); });
            add(map_.at(i_end, j_end), end.is_hit ? kOccupied : kFree);
        }
    }

private:
    BeamEnds beam_ends_;
    FlatMap<float> map_;
};

class MarkAndClear final : public Mapper {
public:
    explicit MarkAndClear(const Column& column)
        : beam_ends_(column.sensor), map_(column.half_side, column.cell_size, std::uint8_t{255}) {}

    void insert(const Scan& scan) override {
        const auto& ends = beam_ends_.of(scan);
        const int i = map_.index_of(scan.pose->x);
        const int j = map_.index_of(scan.pose->y);
        for (const BeamEnd& end : ends) {
            for_each_on_line(i, j, map_.index_of(end.x), map_.index_of(end.y), map_.side,
                             [&](std::size_t at) { map_.cells[at] = 0; });
        }
        for (const BeamEnd& end : ends) {
            if (end.is_hit) map_.cells[map_.at(map_.index_of(end.x), map_.index_of(end.y))] = 254;
        }
    }

private:
    BeamEnds beam_ends_;
    FlatMap<std::uint8_t> map_;
};

class OnceAScan final : public Mapper {
public:
    explicit OnceAScan(const Column& column)
        : beam_ends_(column.sensor), map_(column.half_side, column.cell_size, Cell{}) {}

    void insert(const Scan& scan) override {
        const auto& ends = beam_ends_.of(scan);
        const int i = map_.index_of(scan.pose->x);
        const int j = map_.index_of(scan.pose->y);
        passed_ += 2;
        for (const BeamEnd& end : ends) {
            if (!end.is_hit) continue; // ignored by this mapper, with the free cells before its end
            const int i_end = map_.index_of(end.x);
            const int j_end = map_.index_of(end.y);
            for_each_on_line(i, j, i_end, j_end, map_.side, [&](std::size_t at) { pass(map_.cells[at]); });
            hit(map_.cells[map_.at(i_end, j_end)]);
        }
    }

private:
    struct Cell {
        float log_odds = 0.0F;
        std::int32_t changed = -1; ///< the last scan that changed it
    };

    void pass(Cell& cell) const {
        if (cell.changed >= passed_) return;
        cell.log_odds = std::max(cell.log_odds + kFree, -kClamp);
        cell.changed = passed_;
    }

    void hit(Cell& cell) const {
        if (cell.changed > passed_) return;
        if (cell.changed == passed_) cell.log_odds -= kFree;
        cell.log_odds = std::min(cell.log_odds + kOccupied, kClamp);
        cell.changed = passed_ + 1;
    }

    BeamEnds beam_ends_;
    FlatMap<Cell> map_;
    std::int32_t passed_ = 0;
};

class FillPoly final : public Mapper {
public:
    explicit FillPoly(const Column& column)
        : beam_ends_(column.sensor), map_(column.half_side, column.cell_size, std::int16_t{0}),
          mask_(map_.side, map_.side, CV_8UC1, cv::Scalar(0)) {}

    void insert(const Scan& scan) override {
        const auto& ends = beam_ends_.of(scan);
        corners_.clear();
        corners_.emplace_back(map_.index_of(scan.pose->x), map_.index_of(scan.pose->y));
        for (const BeamEnd& end : ends) corners_.emplace_back(map_.index_of(end.x), map_.index_of(end.y));
        const cv::Rect box = cv::boundingRect(corners_);
        cv::Mat seen = mask_(box);
        cv::Mat cells = cv::Mat(map_.side, map_.side, CV_16SC1, map_.cells.data())(box);
        seen.setTo(0);
        for (auto& corner : corners_) corner -= box.tl();
        cv::fillPoly(seen, std::vector{corners_}, cv::Scalar(1));
        cv::subtract(cells, cv::Scalar(4500), cells, seen);
    }

private:
    BeamEnds beam_ends_;
    FlatMap<std::int16_t> map_;
    cv::Mat mask_;
    std::vector<cv::Point> corners_;
};

/// The limit: the rows of cells are precomputed, and each is added once.
class Spans final : public Mapper {
public:
    explicit Spans(const Column& column) : map_(column.half_side, column.cell_size, std::int16_t{0}) {
        const auto ring = mapping::make_fan_ring(mapping::make_beam_fan(column.sensor.angles, 0.017453292519943295));
        for (const Scan& scan : column.scans) spans_.push_back(spans_of(column, ring, scan));
    }

    void insert(const Scan& scan) override {
        for (const Span& span : spans_[scan_index(scan)]) add(map_.cells.data() + span.begin, span.count, span.amount);
    }

private:
    struct Span {
        std::size_t begin;
        std::size_t count;
        std::int16_t amount;
    };

    [[nodiscard]] std::size_t scan_index(const Scan& scan) const { return scan.seq - 1; }

    static void add(std::int16_t* cells, std::size_t count, std::int16_t amount) {
        for (std::size_t n = 0; n < count; ++n) {
            const int sum = cells[n] + amount;
            cells[n] = static_cast<std::int16_t>(std::clamp<int>(sum, std::numeric_limits<std::int16_t>::min(),
                                                                 std::numeric_limits<std::int16_t>::max()));
        }
    }

    /// Returns runs of cells with the same verdict, joined across chunks.
    std::vector<Span> spans_of(const Column& column, const mapping::FanRing& ring, const Scan& scan) {
        std::vector<Span> spans;
        const mapping::Sweep::Band band{&ring, 0.1};
        const ReadingRules readings{column.sensor.range_min, column.sensor.range_max, false};
        mapping::Sweep sweep({scan.ranges, *scan.pose, readings, column.cell_size}, {&band, 1});
        for (std::size_t strip = 0; strip < sweep.strips(); ++strip) {
            sweep.visit(strip, [&](grid::ChunkKey key, std::span<const mapping::ChunkVerdicts> verdicts) {
                add_runs(spans, key, verdicts.front().free, -4500);
                add_runs(spans, key, verdicts.front().occupied, 4500);
            });
        }
        std::ranges::sort(spans, {}, &Span::begin);
        std::vector<Span> joined;
        for (const Span& span : spans) {
            const bool follows = !joined.empty() && joined.back().begin + joined.back().count == span.begin &&
                                 joined.back().amount == span.amount;
            if (follows) joined.back().count += span.count;
            if (!follows) joined.push_back(span);
        }
        return joined;
    }

    void add_runs(std::vector<Span>& spans, grid::ChunkKey key, const grid::BitPlane& plane, std::int16_t amount) {
        for (std::size_t j = 0; j < plane.size(); ++j) {
            std::uint64_t row = plane[j];
            while (row != 0) {
                const int begin = std::countr_zero(row);
                const int count = std::countr_one(row >> begin);
                const int i = key.ci * grid::kChunkSide + begin + map_.half;
                spans.push_back({map_.at(i, key.cj * grid::kChunkSide + static_cast<int>(j) + map_.half),
                                 static_cast<std::size_t>(count), amount});
                row = begin + count == 64 ? 0 : row >> (begin + count) << (begin + count);
            }
        }
    }

    FlatMap<std::int16_t> map_;
    std::vector<std::vector<Span>> spans_;
};

template <class Made>
Peer peer(std::string name) {
    return {std::move(name), [](const Column& column) { return std::make_unique<Made>(column); }};
}

} // namespace

const std::vector<Peer>& peers() {
    static const auto all = [] {
        std::vector<Peer> made{peer<Bresenham>("bresenham"), peer<MarkAndClear>("mark_and_clear"),
                               peer<OnceAScan>("once_a_scan"), peer<FillPoly>("fill_poly"), peer<Spans>("spans")};
        for (auto& mrpt : mrpt_peer()) made.push_back(std::move(mrpt));
        return made;
    }();
    return all;
}

} // namespace scanloom::bench
