#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace scanloom::auth {

/// The port on which a refusal happened.
enum class Port { kRobot, kHttp };

inline constexpr std::array kPorts = {Port::kRobot, Port::kHttp};

/// Why a connection or a request is refused.
enum class Reason {
    kNoToken,            ///< no token was sent and one is required
    kUnknownToken,       ///< the token that was sent is not in force
    kWrongRole,          ///< the token's role does not permit the action
    kWrongSession,       ///< the token is not for that session
    kForeignPage,        ///< a page of another site sent the request from a browser that is signed in here
    kForeignHost,        ///< the request names a host that is not this server's, as in DNS rebinding
    kLimit,              ///< a limit of the token is reached
    kRevoked,            ///< the token in use no longer permits it
    kNoCertificate,      ///< no client certificate was sent and one is required
    kForeignCertificate, ///< the client certificate was not signed by the configured CA, or is not valid now
};

inline constexpr std::array kReasons = {
    Reason::kNoToken,       Reason::kUnknownToken,      Reason::kWrongRole, Reason::kWrongSession,
    Reason::kForeignPage,   Reason::kForeignHost,       Reason::kLimit,     Reason::kRevoked,
    Reason::kNoCertificate, Reason::kForeignCertificate};

[[nodiscard]] constexpr std::string_view name_of(Port port) noexcept { return port == Port::kRobot ? "robot" : "http"; }

[[nodiscard]] constexpr std::string_view name_of(Reason reason) noexcept {
    switch (reason) {
    case Reason::kNoToken: return "no_token";
    case Reason::kUnknownToken: return "unknown_token";
    case Reason::kWrongRole: return "wrong_role";
    case Reason::kWrongSession: return "wrong_session";
    case Reason::kForeignPage: return "foreign_page";
    case Reason::kForeignHost: return "foreign_host";
    case Reason::kLimit: return "limit";
    case Reason::kRevoked: return "revoked";
    case Reason::kNoCertificate: return "no_certificate";
    case Reason::kForeignCertificate: return "foreign_certificate";
    }
    return "unknown";
}

/// One refused connection or request.
struct Refusal {
    Port port = Port::kRobot;
    Reason reason = Reason::kNoToken;
    std::string who;     ///< address, without a port
    std::string token;   ///< the token's name; empty: not known
    std::string session; ///< as the client sent it, not validated; empty: none

    friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// Limits the log lines about refusals, so that refused clients cannot fill the log. For each address, port and reason
/// the first refusal is reported at once, and later ones in at most one line per minute with their count.
///
/// Bounds: kAddressesMax entries. Refusals beyond are reported together, with the address kOthers.
/// All times are in seconds of a monotonic clock.
class RefusalTable {
public:
    static constexpr std::size_t kAddressesMax = 1024;
    static constexpr double kPauseSeconds = 60.0;
    static constexpr std::string_view kOthers = "others";

    /// A log line about refusals with the same address, port and reason.
    struct Line {
        Refusal newest;
        std::uint64_t count = 0; ///< since the last line

        friend bool operator==(const Line&, const Line&) = default;
    };

    /// Records a refusal.
    /// @return the lines to log now
    [[nodiscard]] std::vector<Line> note(Refusal refusal, double now);

    /// Returns the lines that are due. Call it periodically, so that they appear even if no further refusal occurs.
    [[nodiscard]] std::vector<Line> due(double now);

    /// Returns the lines that have not been reported. Call it before destruction.
    [[nodiscard]] std::vector<Line> rest();

private:
    using Key = std::tuple<std::string, Port, Reason>;
    struct Kept {
        Refusal newest;
        double logged = 0.0;        // time of the last line
        std::uint64_t unlogged = 0; // refusals since then
    };

    void sweep(double now, std::vector<Line>& lines);

    std::map<Key, Kept> kept_;
    double swept_ = 0.0;
};

} // namespace scanloom::auth
