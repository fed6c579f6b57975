#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/wire/messages.hpp"
#include "server/auth/token.hpp"
#include "tests/fault/outcome.hpp"
#include "tests/fault/simulation/world.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::simulation {

/// The tokens of a story: the file that the server's operator edits, and what it permits by the documentation, decided
/// without the code of the server. Checks by it what servers and robots do.
class Tokens {
public:
    /// Draws the tokens of the robots. In half of the stories the server has no tokens and admits every client.
    Tokens(World& world, std::size_t robots);

    /// Returns whether the server has no tokens.
    [[nodiscard]] bool is_open() const { return accounts_.empty(); }

    /// Returns the tokens in the file. Pre: not is_open().
    [[nodiscard]] auth::TokenSet in_file() const;

    /// Changes one token: removes it, gives it another role or other sessions, makes it valid again, or raises limits.
    /// Pre: not is_open().
    void edit();

    /// Makes all tokens valid and raises the limits that a robot cannot wait for. The limits of connections and rates
    /// stay.
    void calm();

    /// Returns the secret that the robot's program uses if it starts now. Some robots have a wrong one for a time.
    [[nodiscard]] std::string secret_of(std::size_t robot) const;

    /// Returns whether a server may have refused the client of this hello for good at some time since `since`.
    [[nodiscard]] bool explains(const wire::Hello& hello, Errc code, Time since) const;

    // Checks of what a server does now

    /// The server passes scans of a link to a session.
    void check_scans(const wire::Hello& hello, std::span<const Scan> scans);
    /// The server has granted a link. `robots` are connected with its token.
    void check_connections(const wire::Hello& hello, std::size_t robots);
    /// The server has read `bytes` from a link since it was granted.
    void check_bytes(const wire::Hello& hello, std::size_t bytes, Duration since_granted);
    /// No server runs.
    void check_sessions(store::MemoryScanLog& durable);
    /// Adds a failure of the server.
    void fail(std::string sentence);

    /// Counts a refusal of this kind.
    void count(std::string_view kind);

    /// Returns the failures, and the counts of refusals as figures.
    [[nodiscard]] fault::Outcome take_outcome();

private:
    enum class Grant { kValid, kRemoved, kViewer, kOtherSessions };

    struct Account {
        std::string name;
        std::string secret;
        Grant grant = Grant::kValid;
        auth::Limits limits;
        Time changed{};
        std::map<Errc, Time> refused_until; // when a reason for this error ended
    };

    [[nodiscard]] const Account* find(std::string_view secret) const;
    [[nodiscard]] static bool refuses(const Account& account, Errc code);
    template <class Change>
    void change(Account& account, Change how);

    World& world_;
    std::vector<Account> accounts_;
    std::vector<std::pair<std::string, Time>> wrong_secrets_; // by robot: until when its program has it
    fault::Outcome outcome_;
};

} // namespace scanloom::simulation
