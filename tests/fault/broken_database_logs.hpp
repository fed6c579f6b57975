#pragma once

#include "server/store/scan_log.hpp"

#include <memory>
#include <string>

/// Logs in a database that several servers share, which each break one of its guarantees.
namespace scanloom::fault {

/// Stores entries of sessions that another server has taken over, in place of what that one has stored.
/// @param address  of the database
[[nodiscard]] std::unique_ptr<store::ScanLog> usurping_log(std::unique_ptr<store::ScanLog> log,
                                                           const std::string& address);

/// Appends entries again if the connection was lost before the database had answered, without asking whether it has
/// them.
[[nodiscard]] std::unique_ptr<store::ScanLog> retrying_log(std::unique_ptr<store::ScanLog> log);

} // namespace scanloom::fault
