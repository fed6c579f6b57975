#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <vector>

namespace scanloom::sessions {

/// Copies a session to a new one that will replace it, and in which the poses that robots sent as poses in the map
/// frame are their odometry, so that the server estimates their poses. Every entry keeps its revision.
///
/// The caller removes the first session. If a crash comes first, settle_copies() decides which of the two counts.
/// Copies that earlier calls left are removed.
/// @param session  that no other thread writes to
/// @param stop     checked from time to time
/// @return the copy, which is complete and durable
/// Errors: kNotFound if there is no such session; kFull if it has more than 4 billion entries; kShuttingDown if `stop` is
///         true; kDataLoss or kMalformed if its record or an entry is damaged; those of ScanLog. After an error, there
///         is no copy, or settle_copies() removes it.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<store::SessionId> copy_as_odometry(store::ScanLog& log, store::SessionId session,
                                                        const std::atomic<bool>& stop);

/// Removes all copies of a session that is still stored.
/// Errors: kNotOwner; kStoreFailed.
/// Threads: any thread that may wait for the disk, while no other copies the session.
[[nodiscard]] Result<> remove_copies(store::ScanLog& log, store::SessionId session);

/// Removes copies that a crash left incomplete or damaged, copies of sessions that went on since, and sessions that
/// another copy replaces.
/// @param stored  all sessions
/// @return those that are left
/// Errors: kStoreFailed.
/// Threads: any thread that may wait for the disk, while no other changes the sessions.
[[nodiscard]] Result<std::vector<store::StoredSession>> settle_copies(store::ScanLog& log,
                                                                      std::vector<store::StoredSession> stored);

/// Returns the sessions without copies of sessions that still exist. In a log that several servers share, another one
/// may be writing such a copy; removing the session makes the copy count.
/// @param stored  all sessions
[[nodiscard]] std::vector<store::StoredSession> without_copies(std::vector<store::StoredSession> stored);

} // namespace scanloom::sessions
