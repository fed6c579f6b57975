#pragma once

#include <string_view>

/// Sockets of a server that breaks its promises: the system's calls accept() and close() of whatever program this is
/// linked to go through here.
namespace scanloom::fault {

/// "hoarding": each connection that is accepted takes a MiB of memory for ever. "clinging": connections that were
/// accepted are never closed. Another name breaks nothing.
void break_sockets(std::string_view kind);

} // namespace scanloom::fault
