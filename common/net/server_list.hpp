#pragma once

#include "common/net/connect.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::net {

/// The servers that a client may use, which share their sessions if there are several, and the choice of the next one.
///
/// The order in which servers are tried depends on the session alone. So all robots of a session begin with the same
/// server, the sessions are spread over the servers, and those of a server that fails are spread over the others.
/// Source: Thaler, Ravishankar, Using name-based mappings to increase hit rates, 1998 (rendezvous hashing), with SHA-256.
class ServerList {
public:
    /// @param servers  at least one
    ServerList(std::vector<Address> servers, std::string_view session);

    /// Returns the server to connect to.
    [[nodiscard]] const Address& current() const noexcept { return sent_to_ ? *sent_to_ : servers_[order_[next_]]; }

    /// Returns the number of the current server in the list as given; nullopt: another server has named it.
    [[nodiscard]] std::optional<std::size_t> index() const noexcept {
        return sent_to_ ? std::nullopt : std::optional(order_[next_]);
    }

    /// Returns whether another server than the current one may be tried.
    [[nodiscard]] bool has_others() const noexcept { return servers_.size() > 1 || sent_to_; }

    /// Chooses another server after the current one could not be used.
    /// @param address  that it has named instead, HOST:PORT; empty: none
    /// @return whether to connect at once: it named a server, or not all of the list were tried since the last wait.
    ///         False if servers were named kRedirectsMax times in a row, as when they disagree.
    [[nodiscard]] bool choose_another(std::string_view address);

    /// The current server is in use.
    void settle() noexcept {
        redirects_ = 0;
        tried_ = 0;
        wait_max_ = kLong;
    }

    /// Returns the longest time to wait before connecting again. It is short after a server has named another one: if
    /// that one is dead, the session is free in a few seconds. It is at most kSeveralMax if there are several servers.
    [[nodiscard]] std::chrono::milliseconds wait_max() const noexcept {
        return servers_.size() > 1 ? std::min(wait_max_, kSeveralMax) : wait_max_;
    }

    /// Returns the longest time to wait for a connection: short if another server may be tried instead.
    [[nodiscard]] std::chrono::milliseconds connect_max(std::chrono::milliseconds alone) const noexcept {
        return servers_.size() > 1 ? std::min(alone, kConnectMax) : alone;
    }

    /// Returns for how long the current server's system may accept nothing of what was sent, see
    /// set_unconfirmed_max(); nullopt: any time. After that others may have its sessions.
    [[nodiscard]] std::optional<std::chrono::milliseconds> unconfirmed_max() const noexcept {
        return servers_.size() > 1 ? std::optional(kUnconfirmedMax) : std::nullopt;
    }

    static constexpr std::chrono::milliseconds kConnectMax{3000};
    static constexpr std::chrono::milliseconds kUnconfirmedMax{5000};
    static constexpr int kRedirectsMax = 4;
    static constexpr std::chrono::milliseconds kShort{1000};
    static constexpr std::chrono::milliseconds kSeveralMax{3000};

private:
    static constexpr std::chrono::milliseconds kLong = std::chrono::hours(24);

    std::vector<Address> servers_;
    std::vector<std::size_t> order_; // numbers of servers_
    std::size_t next_ = 0;           // in order_
    std::optional<Address> sent_to_;
    std::size_t tried_ = 0; // of the list, since the last wait
    int redirects_ = 0;     // in a row
    std::chrono::milliseconds wait_max_ = kLong;
};

/// Parses one or more addresses, HOST:PORT[,HOST:PORT...]. There may be spaces around them.
/// Errors: those of parse_address().
[[nodiscard]] Result<std::vector<Address>> parse_addresses(std::string_view text);

/// Returns the addresses in the given order, with commas between them.
[[nodiscard]] std::string text_of(const std::vector<Address>& addresses);

} // namespace scanloom::net
