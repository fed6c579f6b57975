#pragma once

#include "common/error/error.hpp"
#include "core/localization/estimation_state.hpp"
#include "core/mapping/projection.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <optional>

/// The checkpoint of a projection in the store. With it, recovery replays only the rest of the log.
///
/// Parts, in the order in which the store visits them; integers are little-endian:
///   format                   mapping::kProjectionVersion, version of the parts
///   head                     revision, bounds, pages
///   head/exclusions          the Exclusions and the number of scans of each robot that they leave out; only if there
///                            are exclusions
///   head/estimation          only if the poses of a robot are estimated: version of the estimation, what is stored of
///                            it, and how well the poses of each robot are known
///   robot/<index>            last seq, scan count, revision, stamp and pose of the newest scan, if any, name, a zero
///                            byte, source
///   sensor/<index>/<id>      a SensorDescribed entry, encoded as in the log
///   slam/correction/<number>/<piece>
///                            the pose graph at a correction of the maps, compressed
///   slam/scans/<block>       the points of 64 keyframes, compressed; the last block has fewer
///   slam/state/<slot>/<piece>
///                            the rest of the state of the estimation, compressed
///   weave/laser/<chunk>      revision and cells of one chunk, layer by layer, compressed
///   weave/sonar/<chunk>      revision and cells of one chunk, compressed
/// <index>, <id> and <chunk> are fixed-width hexadecimal numbers. Trajectories are stored only in the log
/// (stored_trajectories.hpp).
///
/// A checkpoint is written in pieces of 4 MiB, measured before compression: the format first, then the chunks. The
/// parts that must agree on the revision are the last piece: head, robots, and the sensors described since the last
/// checkpoint. A checkpoint that a crash interrupted is usable: its chunks may be newer than its head, and the revision
/// of a chunk states which entries of the log it contains.
///
/// The state of the estimation grows with the log, so it is not in the last piece. It is written to one of two slots,
/// in turn: that of the stored checkpoint stays until the last piece names the other one. Scans and corrections never
/// change, so only those that the stored checkpoint lacks are written; the last piece has their numbers.
namespace scanloom::sessions {

/// Writes the parts that changed after `since`. Without `since`, replaces the whole checkpoint.
///
/// @param snapshot,state  taken at the same revision
/// @param estimation  likewise; nullopt: no robot's poses are estimated
/// @param stop  checked between two pieces
/// Errors: kStoreFailed; kShuttingDown if `stop` became true; kOverloaded if memory ran out.
/// Threads: any thread except the store's; waits for the disk.
[[nodiscard]] Result<> write_checkpoint(store::ScanLog& log, store::SessionId session,
                                        const mapping::Snapshot& snapshot, const mapping::ProjectionState& state,
                                        std::optional<Revision> since, const std::atomic<bool>& stop,
                                        const std::optional<localization::EstimationState>& estimation = {});

/// Returns the state of the estimation for a checkpoint; nullopt if no robot's poses are estimated.
[[nodiscard]] std::optional<localization::EstimationState>
estimation_to_store(const localization::LocalizedProjection& maps);

} // namespace scanloom::sessions
