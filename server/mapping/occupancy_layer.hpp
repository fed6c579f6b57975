#pragma once

#include "server/grid/chunk_tree.hpp"
#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/log_odds.hpp"
#include "server/mapping/map_config.hpp"

#include <map>

namespace scanloom::mapping {

using OccupancyChunk = grid::Chunk<LogOdds>;
using OccupancyView = grid::ChunkView<OccupancyChunk>;

/// The occupancy grid of a session: fixed-point log-odds, updated scan by scan.
///
/// Update  l = clamp(l + model(cell) - l0, l_min, l_max), unseen cells starting from the prior l0.
/// Thread  one writer; views may be read by anyone.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.1.
class OccupancyLayer {
public:
    explicit OccupancyLayer(const MapConfig& config);

    /// Adds the evidence of one scan, or of some of its sectors; the cells changed carry `revision`.
    /// Pre     ranges has a reading for each beam of the fan; revision >= every earlier one.
    /// @return smallest box holding the changed cells.
    grid::CellBox integrate(std::span<const Sector> sectors, std::span<const RangeMm> ranges, const Pose2& T_map_sensor,
                            const ModelGeometry& geometry, Revision revision);

    /// Puts back a chunk of a checkpoint. It holds everything up to its revision already, so that scans
    /// up to that one leave it as it is when they are integrated again.
    /// Source  the page LSN of Mohan et al., ARIES (1992), section 6.
    void restore(grid::ChunkKey key, Revision revision, std::span<const LogOdds> cells);

    /// The newest revision of any chunk put back.
    [[nodiscard]] Revision newest_restored() const noexcept { return newest_restored_; }

    [[nodiscard]] std::size_t chunk_count() const noexcept { return tree_.size(); }

    [[nodiscard]] OccupancyView snapshot() { return tree_.snapshot(); }

private:
    struct Step {
        int amount; // may exceed what a cell can hold: from one end of the clamp to the other
        LogOdds l_min;
        LogOdds l_max;
        LogOdds prior;
    };

    static void apply(std::span<LogOdds> cells, const Step& step) noexcept;
    [[nodiscard]] bool holds_already(grid::ChunkKey key, Revision revision) const;

    Step free_;
    Step occupied_;
    grid::ChunkTree<OccupancyChunk> tree_;
    std::map<grid::ChunkKey, Revision> restored_; // dropped once all of them are overtaken
    Revision newest_restored_ = 0;
};

} // namespace scanloom::mapping
