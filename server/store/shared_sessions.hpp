#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store {

/// How the servers that share a log reach each other.
struct NodeInfo {
    std::string name;   ///< unique among the servers that share the log
    std::string robots; ///< where robots connect, HOST:PORT; empty: nowhere, as it is starting or stopping
    std::string http;   ///< SCHEME://HOST:PORT
    std::string build;  ///< version of the program
};

/// A server as the others see it.
struct Node {
    std::shared_ptr<const NodeInfo> info;
    std::chrono::milliseconds silent{}; ///< time since it last wrote that it lives
    bool is_alive = false;
    bool is_dead =
        false; ///< others may take its sessions; neither is true for a moment after a failover of the database
    bool is_self = false;
    std::size_t sessions = 0; ///< that it owns
};

/// A session with the server that has it.
struct SharedSession {
    Revision end = 0;                           ///< of its log
    std::shared_ptr<const NodeInfo> owner = {}; ///< null: this server, or none that lives
    bool is_own = false;                        ///< this server has it
};

/// The servers, by name, and the sessions that have a name.
struct SharedList {
    std::vector<Node> nodes;
    std::map<SessionId, SharedSession> sessions;
};

struct FoundSession {
    StoredSession stored;
    SharedSession shared;
};

/// The sessions of a log that several servers (nodes) share. Each is changed by one node at a time, its owner.
///
/// A node owns the sessions that it creates, and those that it takes with own(). While it lives, it has them until it
/// gives them up. A node that has not written to the log for some seconds counts as dead, and others may take its
/// sessions; what it writes later has no effect and fails with kNotOwner.
/// Threads: any, concurrently. All functions may wait for the database.
class SharedSessions {
public:
    SharedSessions() = default;
    SharedSessions(const SharedSessions&) = delete;
    SharedSessions& operator=(const SharedSessions&) = delete;
    virtual ~SharedSessions() = default;

    /// Makes this node the owner of a session, if it is not. All that earlier owners wrote is durable then.
    /// Errors: kNotFound: no such session; kNotOwner: a node that lives owns it, which the message names; kStoreFailed.
    [[nodiscard]] virtual Result<> own(SessionId session) = 0;

    /// Gives a session up, after everything that was submitted for it. Does nothing if this node does not own it.
    /// Errors: kStoreFailed: it stays the owner.
    [[nodiscard]] virtual Result<> disown(SessionId session) = 0;

    /// Checks that no other node has taken a session, as during a pause of this one: what this node knows of it was
    /// true at some time during the call.
    /// Errors: those of own().
    [[nodiscard]] virtual Result<> confirm(SessionId session) = 0;

    /// Returns the session with this name; nullopt: there is none.
    [[nodiscard]] virtual Result<std::optional<FoundSession>> find(std::string_view name) = 0;

    /// Returns all servers and sessions.
    [[nodiscard]] virtual Result<SharedList> list() = 0;

    /// Returns a secret that the servers of this log have in common.
    [[nodiscard]] virtual const std::string& secret() const = 0;

    /// Enters this node's addresses and version for the others. If it fails, it is repeated.
    [[nodiscard]] virtual Result<> announce(const NodeInfo& info) = 0;
};

/// Makes this server the owner of a session, if several share the log.
/// Errors: those of SharedSessions::own().
[[nodiscard]] inline Result<> own(ScanLog& log, SessionId session) {
    auto* const shared = log.shared();
    return shared == nullptr ? Result<>() : shared->own(session);
}

} // namespace scanloom::store
