#pragma once

#include "common/error/error.hpp"

#include <memory>
#include <string_view>
#include <vector>

/// How the list of sessions is filled: at the start, and later with the sessions of other servers that share the log.
namespace scanloom::sessions {

struct RegistryState;
class Session;

/// Finds the stored sessions when the server starts, and adds each to the cache or to the damaged sessions.
///
/// A session with a checkpoint at the end of its log stays out of memory. For the others, the newest checkpoint is
/// loaded and the rest of the log is replayed. A session whose import was interrupted is removed. If the
/// memory for maps is exceeded, a recovered session is evicted at once. If RegistryState::draining becomes true, the
/// recovery stops; the entries applied so far are kept in checkpoints. Of a log that several servers share, no session
/// is loaded: whichever server is asked for it first owns it.
/// Errors: kStoreFailed if the sessions cannot be listed.
/// Threads: one call, which blocks; not on a thread of the config's executors.
[[nodiscard]] Result<> recover_sessions(RegistryState& state);

/// Adds a session to the cache that another server has created since the list was read.
/// Errors: kNotFound: there is none, or the log is not shared; kStoreFailed.
/// Threads: any thread that may wait for the store.
[[nodiscard]] Result<> discover(RegistryState& state, std::string_view name);

/// Adds all sessions to the cache that other servers have created, and drops the unloaded ones that they have removed.
/// Does nothing if the log is not shared.
/// @return the sessions in memory that another server has taken or removed: to be closed, and evicted from the cache
/// Errors: kStoreFailed.
/// Threads: any thread that may wait for the store.
[[nodiscard]] Result<std::vector<std::shared_ptr<Session>>> discover_all(RegistryState& state);

} // namespace scanloom::sessions
