#pragma once

#include <string_view>

/// Sockets of a server that breaks its guarantees. Replaces the system calls accept() and close() in the program that
/// links this file.
namespace scanloom::fault {

/// Selects the fault. "hoarding": each accepted connection leaks 1 MiB of memory. "clinging": accepted connections are
/// never closed. Another name selects no fault.
void break_sockets(std::string_view kind);

} // namespace scanloom::fault
