#pragma once

#include "common/error/error.hpp"
#include "common/net/connect.hpp"

#include <string>
#include <string_view>

namespace scanloom::robot {

/// An address on a network with a scheme, such as ws://robot.lan:8765/path.
struct Url {
    bool is_encrypted = false;
    net::Address address;
    std::string target = "/"; ///< path and query
    std::string text;         ///< as people wrote it
};

/// What a URL must look like.
struct UrlForm {
    std::string_view plain;        ///< scheme with "://"
    std::string_view encrypted;    ///< scheme with "://"
    std::string_view default_port; ///< used if the URL has none
};

inline constexpr UrlForm kWebSocketUrl{"ws://", "wss://", "8765"};
inline constexpr UrlForm kHttpUrl{"http://", "https://", "8080"};

/// Parses SCHEME://HOST[:PORT][/PATH].
/// Errors: kInvalidField if the text has another form.
[[nodiscard]] Result<Url> parse_url(std::string_view text, const UrlForm& form);

} // namespace scanloom::robot
