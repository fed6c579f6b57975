#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/scan.hpp"
#include "core/mapping/beam_fan.hpp"
#include "core/mapping/laser_chunk.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::mapping {

/// A fan as a closed ring of sectors in counter-clockwise order, including the parts that no beam sees. Sector m lies
/// between the edges m and m + 1; the last edge equals the first.
///
/// The edges are unit vectors in the sensor frame: sectors + 1 values, then kRingPadding zeros, so that a vector
/// register can be loaded from any edge.
struct FanRing {
    static constexpr std::uint32_t kNoBeam = 0xFFFF'FFFFU; ///< no beam sees the sector

    std::size_t sectors = 0;          ///< of the whole turn
    std::size_t in_order = 0;         ///< number of leading sectors for which sector m belongs to beam m
    std::vector<std::uint32_t> beams; ///< beam of each sector; kNoBeam: unseen
    std::vector<double> edges_x;      ///< components along x
    std::vector<double> edges_y;      ///< components along y
};

/// More values than any vector register has lanes of doubles.
inline constexpr std::size_t kRingPadding = 40;

/// Returns the fan as a ring, with the parts that no beam sees added.
/// @param fan  sectors in the sensor frame
[[nodiscard]] FanRing make_fan_ring(const BeamFan& fan);

/// Evaluates the inverse sensor model of one scan for each cell, without approximation, chunk by chunk.
///
/// The verdict for a cell depends on the distance r of its centre, on the beam k whose sector contains the centre (the
/// nearest beam, within half the aperture), and on the reading z of that beam:
///   occupied  z < range_max and |r - z| < alpha / 2
///   free      r <= z, r <= range_max, and not occupied
///   (none)    otherwise, and if reading_of() returns no reading for the beam
///
/// The free area, and the free and occupied area, are each bounded by a closed line of arcs and of straight pieces
/// between beams. Each line is intersected with the rows of cells once, whatever the number of cells inside.
///
/// A sweep can evaluate two bands of the same scan at once, because evidence and HIMM counters have different alphas
/// and apertures.
/// Cost: sectors, crossings of rows, chunks of the area that the scan sees; independent of the map's size.
/// Memory: kept by each thread from scan to scan: 256 bytes per sector and contour (at most four) for the pieces that
///         cross rows, tens of bytes per sector for the rest, and 256 KiB per contour or as much as one row of chunks
///         needs.
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.2. A printed variant compares r with z_max in
///         the occupied test, which is a misprint.
class Sweep {
public:
    /// One inverse sensor model to evaluate.
    struct Band {
        const FanRing* ring; ///< not null
        double thickness;    ///< alpha, metres; at least one cell is used
    };

    /// The inputs common to all bands.
    struct Scene {
        std::span<const RangeMm> ranges; ///< one for each beam of the fans
        Pose2 T_map_sensor;              ///< pose of the sensor at the scan: metres, radians
        ReadingRules readings;           ///< range limits of the sensor
        double cell_size;                ///< metres
    };

    static constexpr std::size_t kBandsMax = 2; ///< one for evidence, one for HIMM

    /// Prepares the sweep of a scan. The arguments need not outlive the constructor.
    /// @param scene  the scan and the map's cell size
    /// @param bands  one or two
    /// Threads: a thread may have only one sweep at a time.
    Sweep(const Scene& scene, std::span<const Band> bands);

    /// Returns the number of strips to visit. The caller may stop after any strip and continue later with an equal
    /// sweep.
    [[nodiscard]] std::size_t strips() const noexcept { return strips_; }

    /// Calls chunk(grid::ChunkKey, std::span<const ChunkVerdicts>) with the verdicts of each band, for every chunk of
    /// the strip in which any band has a verdict.
    /// @param strip  from 0
    /// @param chunk  called for the chunks of each row from left to right, the bottom row first
    /// Precondition: strip < strips().
    template <class Chunk>
    void visit(std::size_t strip, Chunk&& chunk) {
        begin(strip);
        for (std::int32_t row = 0; row < strip_rows_; ++row) {
            begin_row();
            for (std::int32_t column = 0; column < columns_; ++column) {
                if (!fill(row, column)) continue;
                const grid::ChunkKey key{.cj = first_row_ + row, .ci = first_.ci + column};
                chunk(key, std::span<const ChunkVerdicts>(verdicts_).first(bands_));
            }
        }
        end();
    }

    /// Working memory that each thread keeps from sweep to sweep.
    struct Room;

private:
    void take_in(const Scene& scene, std::span<const Band> bands);
    void lay_out(const Scene& scene);
    void begin(std::size_t strip);
    void clear();
    void begin_row();
    [[nodiscard]] bool fill(std::int32_t row, std::int32_t column);
    void end();

    Room& room_;
    std::size_t bands_;
    std::size_t strips_ = 0;
    grid::ChunkKey first_;            ///< lower left chunk of all strips
    std::int32_t columns_ = 0;        ///< chunks
    std::int32_t rows_ = 0;           ///< chunks
    std::int32_t strip_rows_max_ = 0; ///< chunks
    double x_ = 0.0;                  ///< the sensor's position within its cell
    double y_ = 0.0;
    grid::Cell cell_; ///< the sensor's cell

    // The strip that is being visited.
    std::int32_t first_row_ = 0;  ///< in chunks
    std::int32_t strip_rows_ = 0; ///< chunks
    std::array<ChunkVerdicts, kBandsMax> verdicts_;
};

} // namespace scanloom::mapping
