#pragma once

#include "common/error/error.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::store::postgres {

/// Where a database is: postgresql://USER@HOST[:PORT][,HOST[:PORT]...]/DATABASE, as libpq reads it.
struct Place {
    struct Host {
        std::string name; ///< a name, an address, or the folder of a socket
        std::string port;
    };
    std::vector<Host> hosts;
    std::vector<std::pair<std::string, std::string>> settings; ///< all other parameters of libpq
    std::string text;                                          ///< for messages: without a password
};

/// Returns whether a value of --store names a database.
[[nodiscard]] bool is_place(std::string_view text);

/// Reads the address of a database.
/// Errors: kInvalidField: it is not an address, or has no database.
[[nodiscard]] Result<Place> parse_place(const std::string& url);

/// Returns a text of libpq in one line, with single spaces and without a full stop at the end.
[[nodiscard]] std::string one_line(std::string_view text);

} // namespace scanloom::store::postgres
