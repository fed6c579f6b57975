#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/scan.hpp"
#include "server/mapping/laser_chunk.hpp"
#include "server/mapping/sweep/fan_ring.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace scanloom::mapping {

/// Tells which cells one scan shows to be free or occupied, chunk by chunk: the inverse sensor model, cell by cell
/// exact.
///
/// A cell whose centre lies at distance r in the sector of beam k (its nearest, within half the aperture), with reading
/// z:
///   occupied  z < range_max and |r - z| < alpha / 2
///   free      r <= z, r <= range_max, and not occupied
///   (nothing) otherwise, and where reading_of() says that the beam shows nothing.
/// What is free, and what is free or occupied, is the area within a closed line of arcs and of straight pieces between
/// beams; each line is crossed with the rows of cells once, whatever the number of cells inside.
///
/// Two bands may be asked for at once, of the same scan: evidence and counts have an alpha and an aperture each.
/// Cost    sectors, crossings of rows, chunks of the area that the scan sees; never the map's size.
/// Memory  kept by each thread from scan to scan: 256 bytes a sector and contour, of four at most, for the pieces that
///         cross rows; tens of bytes a sector for the rest; and 256 KiB a contour, or what one row of chunks needs.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.2. (A printed variant compares r with z_max in the
///         occupied test: a misprint.)
class Sweep {
public:
    struct Band {
        const FanRing* ring;
        double thickness; ///< alpha, metres; at least one cell is used
    };

    /// What every band shares.
    struct Scene {
        std::span<const RangeMm> ranges; ///< one for each beam that the rings were made from
        Pose2 T_map_sensor;
        ReadingRules readings;
        double cell_size; ///< metres
    };

    static constexpr std::size_t kBandsMax = 2;

    /// Pre  one or two bands; until it is gone, the thread makes no other.
    Sweep(const Scene& scene, std::span<const Band> bands);

    /// The area is visited strip by strip, so that who has other things to do may give way in between, and go on with
    /// an equal sweep.
    [[nodiscard]] std::size_t strips() const noexcept { return strips_; }

    /// Calls chunk(grid::ChunkKey, std::span<const ChunkVerdicts>), with the verdicts of each band, for every chunk of
    /// the strip in which any band has any. Pre: strip < strips().
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

    /// What the thread keeps from sweep to sweep.
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
    grid::ChunkKey first_;            ///< lower left one of all
    std::int32_t columns_ = 0;        ///< chunks
    std::int32_t rows_ = 0;           ///< chunks
    std::int32_t strip_rows_max_ = 0; ///< chunks
    double x_ = 0.0;                  ///< the sensor's place within its cell
    double y_ = 0.0;
    grid::Cell cell_; ///< the sensor's

    // Of the strip that is being visited.
    std::int32_t first_row_ = 0;  ///< of chunks
    std::int32_t strip_rows_ = 0; ///< chunks
    std::array<ChunkVerdicts, kBandsMax> verdicts_;
};

} // namespace scanloom::mapping
