#include "lab/weaving.hpp"

namespace scanloom::lab {
namespace {

constexpr double kOccupiedFrom = 0.65; // probability
constexpr double kFreeUpTo = 0.35;

} // namespace

Result<std::vector<double>> weave(const Recording& recording, const SessionOptions& options, const Now& now,
                                  const AfterScan& after_scan) {
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    mapping::Projection projection(*config);
    for (const LogEntry& entry : {LogEntry(RobotJoined{0, "lab"}), LogEntry(SensorDescribed{0, recording.laser})}) {
        if (auto folded = projection.fold(entry); !folded) return folded.error();
    }
    std::vector<double> seconds;
    for (const Scan& scan : recording.scans) {
        const LogEntry entry = ScanTaken{0, scan};
        const double begun = now();
        const auto folded = projection.fold(entry);
        seconds.push_back(now() - begun);
        if (!folded) return folded.error();
        after_scan(seconds.size(), projection);
    }
    return seconds;
}

MapStates states_of(const mapping::Snapshot& snapshot, const grid::CellBox& box) {
    const auto occupied_from = mapping::to_fixed(mapping::log_odds_of(kOccupiedFrom));
    const auto free_up_to = mapping::to_fixed(mapping::log_odds_of(kFreeUpTo));
    MapStates map{StateGrid(box, CellState::kUnknown), 0};
    snapshot.occupancy.visit({}, 0, [&](grid::ChunkKey at, const mapping::OccupancyChunk& chunk) {
        const grid::Cell corner{at.ci * grid::kChunkSide, at.cj * grid::kChunkSide};
        for_each_cell({corner.i, corner.j, corner.i + grid::kChunkSide, corner.j + grid::kChunkSide},
                      [&](grid::Cell cell) {
                          const mapping::LogOdds l = chunk.at(cell);
                          if (l == mapping::kUnknownLogOdds) return;
                          ++map.touched;
                          if (!box.empty() && map.states.contains(cell)) {
                              map.states.at(cell) = l >= occupied_from ? CellState::kOccupied
                                                    : l <= free_up_to  ? CellState::kFree
                                                                       : CellState::kUnknown;
                          }
                      });
    });
    return map;
}

} // namespace scanloom::lab
