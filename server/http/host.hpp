#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::http {

/// Whether a Host field names this server: "localhost", an address (not a name), or one of `names`,
/// with or without a port, in any case.
///
/// A page of a stranger can point a name of its own at this server's address and would then count
/// as the same origin (DNS rebinding). Its name gives it away.
[[nodiscard]] bool is_known_host(std::string_view host_field, const std::vector<std::string>& names);

} // namespace scanloom::http
