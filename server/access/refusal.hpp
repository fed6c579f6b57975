#pragma once

#include <array>
#include <string>
#include <string_view>

namespace scanloom::access {

enum class Port { kRobot, kHttp };

inline constexpr std::array kPorts = {Port::kRobot, Port::kHttp};

/// Why somebody is not let in, or may not do what he asks.
enum class Reason {
    kNoToken,            ///< none was sent where one is needed
    kUnknownToken,       ///< what was sent is no token that is in force
    kWrongRole,          ///< it is not for that
    kWrongSession,       ///< it is not for that session
    kForeignPage,        ///< a browser that is signed in asks for somebody else's page
    kForeignHost,        ///< a name by which this server does not go, as when a page rebinds its own
    kLimit,              ///< it has all that it may have
    kRevoked,            ///< its token is no longer in force, while it was in use
    kNoCertificate,      ///< none was shown where one is needed
    kForeignCertificate, ///< what was shown, nobody who is trusted here signed, or it is not valid now
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

/// Somebody was not let in.
struct Refusal {
    Port port = Port::kRobot;
    Reason reason = Reason::kNoToken;
    std::string who;     ///< address, without a port
    std::string token;   ///< its name; empty: not known
    std::string session; ///< as it was asked for, unchecked; empty: none

    friend bool operator==(const Refusal&, const Refusal&) = default;
};

} // namespace scanloom::access
