#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_nodes.hpp"
#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom::lab::cluster {

/// A session that a stopped node gives up.
struct Handover {
    std::size_t session = 0;
    std::size_t from = 0;
    std::optional<std::size_t> to; ///< where the robots are sent; none: no other node runs
    Time begin{0};                 ///< when the node begins to close the session: no scan is acknowledged from now on
    Time end{0};                   ///< when it gives the session up
};

/// Which node owns which session, as the table of sessions in the database says.
class Ownership {
public:
    /// @param sessions  how many there are at a time; none exists at first
    Ownership(const Plan& plan, const Draws& draws, std::size_t sessions);

    /// How a session came to the node that was asked for it.
    enum class Change {
        kNone,      ///< the node had it, or another node has it
        kCreated,   ///< it did not exist
        kTakenOver, ///< its owner has failed
        kMoved,     ///< it was given up
    };

    /// The answer of a node to a robot.
    struct Reply {
        std::optional<std::size_t> sent_to; ///< the owner, if it is another node
        Time welcome{0};                    ///< when the robot is welcomed otherwise: the session is loaded then
        Change change = Change::kNone;
    };

    /// A robot asks a node for its session.
    /// Pre: runs(node).
    [[nodiscard]] Reply ask(std::size_t session, std::size_t node, Time now);

    /// A node fails. Pre: runs(node), and `how` is not kStopped.
    void fail(std::size_t node, End how, Time now);

    /// A node is stopped: it takes no more sessions, and closes its own ones, four at a time.
    /// Pre: runs(node), up > now.
    /// @param up  when it starts again; sessions that are not closed by then are given up then
    /// @return its sessions; the caller calls give_up() for each that is not ended before
    [[nodiscard]] std::vector<Handover> stop(std::size_t node, Time now, Time up);

    /// A stopped node has closed the session. The next node that is asked for it has it.
    void give_up(std::size_t session) { sessions_[session].owner.reset(); }

    /// The node starts again, with its name; it owns nothing. Pre: !runs(node), and stop()'s sessions are given up.
    void start(std::size_t node);

    /// The session ends; the next node that is asked for it creates another one.
    void end_session(std::size_t session) { sessions_[session] = {}; }

    [[nodiscard]] bool runs(std::size_t node) const { return nodes_[node].runs; }

    /// Returns how the node has ended that does not run.
    [[nodiscard]] End end_of(std::size_t node) const { return nodes_[node].how; }

    [[nodiscard]] bool exists(std::size_t session) const { return sessions_[session].exists; }

    /// Returns the node that serves the session or loads it: one that runs, or one that is stopped and has not given
    /// the session up.
    [[nodiscard]] std::optional<std::size_t> server_of(std::size_t session) const;

private:
    struct Node {
        bool runs = true;
        End how = End::kStopped;
        std::uint32_t life = 0;        ///< sessions of earlier lives have no owner
        Time dead{0};                  ///< when others may take its sessions, if it does not run
        std::vector<Time> loader_free; ///< for each thread that loads sessions
    };
    struct Session {
        bool exists = false;
        std::optional<std::uint32_t> owner; ///< none: it is given up
        std::uint32_t life = 0;             ///< of the owner, when it took the session
        Time loaded{0};
    };

    [[nodiscard]] Change change_if_asked(const Session& session, Time now) const;
    [[nodiscard]] Time loaded_by(Node& node, Time now) const;

    Draws draws_;
    Time load_;
    double close_ms_;
    std::vector<Node> nodes_;
    std::vector<Session> sessions_;
};

} // namespace scanloom::lab::cluster
