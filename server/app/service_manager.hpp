#pragma once

#include <string_view>

namespace scanloom::app {

/// Reports the state of the server, such as "READY=1" or "STOPPING=1", to the service manager that started it. Does
/// nothing without one, or if the report cannot be sent: the server works without it.
/// Source: sd_notify(3): one datagram to the socket that NOTIFY_SOCKET names, a path or, after @, an abstract name.
void notify_service_manager(std::string_view state) noexcept;

} // namespace scanloom::app
