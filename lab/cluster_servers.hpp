#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace scanloom::lab::cluster {

/// The order in which the robots of a session try the nodes: by decreasing hashes of the session and the node
/// (rendezvous hashing). The order is not stored: the next node is searched for when it is needed.
/// Source: Thaler, Ravishankar, Using name-based mappings to increase hit rates, 1998.
class Order {
public:
    /// @param session  64 bits that differ for each session, instead of its name
    /// @param nodes    how many there are, at least 1
    Order(const Draws& draws, std::uint64_t session, std::size_t nodes)
        : draws_(draws), session_(session), nodes_(static_cast<std::uint32_t>(nodes)) {}

    [[nodiscard]] std::uint32_t nodes() const noexcept { return nodes_; }

    /// Returns the node that the robots try first.
    [[nodiscard]] std::uint32_t first() const;

    /// Returns the node after this one; the first one after the last.
    [[nodiscard]] std::uint32_t after(std::uint32_t node) const;

private:
    using Rank = std::pair<std::uint64_t, std::uint32_t>; // the hash, then the node

    [[nodiscard]] Rank rank_of(std::uint32_t node) const { return {draws_.bits(Use::kRank, session_, node), node}; }

    Draws draws_;
    std::uint64_t session_;
    std::uint32_t nodes_;
};

/// The choice of the next server by a robot, as net::ServerList makes it, with numbers of nodes instead of addresses.
class Servers {
public:
    /// @param first  the first node of the session's order
    explicit Servers(std::uint32_t first) : next_(first) {}

    /// Returns the node to connect to.
    [[nodiscard]] std::size_t current() const noexcept { return sent_to_ == kNone ? next_ : sent_to_; }

    /// Chooses another node after the current one could not be used.
    /// @param named  node that it has named instead
    /// @param order  of the robot's session, always the same
    /// @return whether to connect at once
    [[nodiscard]] bool choose_another(std::optional<std::size_t> named, const Order& order);

    /// The current node is in use.
    void settle() noexcept {
        redirects_ = 0;
        tried_ = 0;
        is_short_ = false;
    }

    /// Returns the longest time to wait before connecting again.
    [[nodiscard]] Time wait_max() const noexcept { return is_short_ ? kShort : kSeveralMax; }

    static constexpr int kRedirectsMax = 4;  ///< as ServerList
    static constexpr Time kShort{1000};      ///< as ServerList
    static constexpr Time kSeveralMax{3000}; ///< as ServerList; also of a robot that knows one node only

private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;

    std::uint32_t next_;
    std::uint32_t sent_to_ = kNone;
    std::uint32_t tried_ = 0;
    std::uint8_t redirects_ = 0;
    bool is_short_ = false;
};

} // namespace scanloom::lab::cluster
