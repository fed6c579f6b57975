#pragma once

#include "common/wire/messages.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

namespace scanloom::ingest {

/// Decides by the number of open connections which new ones a server serves. Has no sockets: the owner performs the
/// decisions.
///
/// Connections that have not sent a hello have their own limit, so that silent connections cannot keep robots out: a
/// robot sends its hello at once. Connections that send it at the same moment may exceed links_max, by at most
/// greeting_max.
/// Threads: one at a time.
class ConnectionLimits {
public:
    /// Bound on connections beyond the limit that stay open to receive the Error; more are closed without one.
    static constexpr std::size_t kTurnedAwayMax = 64;

    /// Identifies a connection. Later connections have higher ids.
    using Id = std::uint64_t;

    /// What to do with a new connection.
    enum class Admission {
        kServe,
        kTurnAway, ///< send it too_many()
        kClose,    ///< close it at once; it has no id
    };

    /// The decision about a new connection.
    struct Decision {
        Admission admission = Admission::kServe;
        Id id = 0;
        std::optional<Id> cut_off = std::nullopt; ///< the oldest connection without a hello, to be closed first
    };

    /// @param links_max     connections that sent a hello
    /// @param greeting_max  connections without a hello, 1 or more
    ConnectionLimits(std::size_t links_max, std::size_t greeting_max)
        : links_max_(links_max), greeting_max_(greeting_max) {}

    /// A connection was accepted. Unless it is closed at once, call on_closed() at its end.
    [[nodiscard]] Decision on_accepted();

    /// The connection's hello has arrived. Ignored if the connection was to be closed before.
    void on_hello(Id id);

    /// The connection is closed.
    void on_closed(Id id);

    /// Returns the number of open connections that sent a hello.
    [[nodiscard]] std::size_t served() const { return count(State::kServed); }

    /// Returns the error for a connection that is turned away. The robot should try again later.
    [[nodiscard]] wire::LinkError too_many() const;

private:
    enum class State { kWithoutHello, kServed, kLeaving };

    void change(std::map<Id, State>::iterator connection, State state);
    [[nodiscard]] std::size_t count(State of) const { return counts_[static_cast<std::size_t>(of)]; }

    std::size_t links_max_;
    std::size_t greeting_max_;
    Id last_ = 0;
    std::map<Id, State> open_;
    std::set<Id> without_hello_;          // oldest first
    std::array<std::size_t, 3> counts_{}; // open connections by state
};

} // namespace scanloom::ingest
