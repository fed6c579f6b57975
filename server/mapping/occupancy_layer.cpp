#include "server/mapping/occupancy_layer.hpp"

#include <algorithm>
#include <cassert>

namespace scanloom::mapping {
namespace {

OccupancyChunk blank_chunk() {
    OccupancyChunk chunk;
    chunk.cells.fill(kUnknownLogOdds);
    return chunk;
}

} // namespace

OccupancyLayer::OccupancyLayer(const MapConfig& config) : tree_(blank_chunk()) {
    const double l0 = log_odds_of(config.p_prior);
    const Step common{0, to_fixed(log_odds_of(config.p_min)), to_fixed(log_odds_of(config.p_max)), to_fixed(l0)};
    free_ = occupied_ = common;
    free_.amount = to_fixed(log_odds_of(config.p_free)) - common.prior;
    occupied_.amount = to_fixed(log_odds_of(config.p_occupied)) - common.prior;
}

void OccupancyLayer::apply(std::span<LogOdds> cells, const Step& step) noexcept {
    for (LogOdds& cell : cells) {
        const int before = cell == kUnknownLogOdds ? step.prior : cell;
        cell = static_cast<LogOdds>(std::clamp<int>(before + step.amount, step.l_min, step.l_max));
    }
}

grid::CellBox OccupancyLayer::integrate(std::span<const Sector> sectors, std::span<const RangeMm> ranges,
                                        const Pose2& T_map_sensor, const ModelGeometry& geometry, Revision revision) {
    if (revision > newest_restored_) restored_.clear();
    grid::CellBox changed;
    grid::ChunkKey current_key;
    OccupancyChunk* current = nullptr; // neighbouring runs mostly fall into the same chunk
    inverse_sensor_model(sectors, ranges, T_map_sensor, geometry,
                         [&](Verdict verdict, std::int32_t j, std::int32_t begin, std::int32_t end) {
                             changed.include_row(j, begin, end);
                             const Step& step = verdict == Verdict::kFree ? free_ : occupied_;
                             for (std::int32_t i = begin; i < end;) {
                                 const grid::ChunkKey key = grid::chunk_of({i, j});
                                 const std::int32_t piece_end = std::min(end, (key.ci + 1) * grid::kChunkSide);
                                 if (holds_already(key, revision)) {
                                     i = piece_end;
                                     continue;
                                 }
                                 if (current == nullptr || key != current_key) {
                                     current = &tree_.write(key, revision);
                                     current_key = key;
                                 }
                                 apply({&current->at({i, j}), static_cast<std::size_t>(piece_end - i)}, step);
                                 i = piece_end;
                             }
                         });
    return changed;
}

bool OccupancyLayer::holds_already(grid::ChunkKey key, Revision revision) const {
    if (restored_.empty()) return false;
    const auto restored = restored_.find(key);
    return restored != restored_.end() && revision <= restored->second;
}

void OccupancyLayer::restore(grid::ChunkKey key, Revision revision, std::span<const LogOdds> cells) {
    restored_[key] = revision;
    newest_restored_ = std::max(newest_restored_, revision);
    auto& chunk = tree_.write(key, revision);
    assert(cells.size() == chunk.cells.size());
    std::copy(cells.begin(), cells.end(), chunk.cells.begin());
}

} // namespace scanloom::mapping
