#pragma once

#include <string_view>

namespace scanloom::app {

/// Tells whoever started the server as a service how it is: "READY=1", "STOPPING=1". Nothing where nobody listens.
///
/// Source  sd_notify(3): one datagram to the socket that NOTIFY_SOCKET names, a path or, after @, an abstract name.
/// Errors  none: a server that cannot tell serves all the same.
void tell_service_manager(std::string_view state) noexcept;

} // namespace scanloom::app
