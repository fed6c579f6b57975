#pragma once

#include "server/store/scan_log.hpp"

#include <memory>
#include <string_view>

/// Scan logs that break their promises, each in one way: what the rows of faults must not let pass.
namespace scanloom::fault {

/// Says that entries are durable and writes them later, some at a time: a crash takes the others.
[[nodiscard]] std::unique_ptr<store::ScanLog> hasty_log(std::unique_ptr<store::ScanLog> log);

/// Appends some batches twice, as who forgets what it has done already.
[[nodiscard]] std::unique_ptr<store::ScanLog> forgetful_log(std::unique_ptr<store::ScanLog> log);

/// Reads other scans than were written and does not notice, as a store without checksums may.
[[nodiscard]] std::unique_ptr<store::ScanLog> blind_log(std::unique_ptr<store::ScanLog> log);

/// Takes entries for old ones, and drops them, while the wall clock shows less than when it was opened.
[[nodiscard]] std::unique_ptr<store::ScanLog> misled_log(std::unique_ptr<store::ScanLog> log);

/// Never lets go of the memory of what it was given, 64 KiB an entry.
[[nodiscard]] std::unique_ptr<store::ScanLog> leaky_log(std::unique_ptr<store::ScanLog> log);

/// Says that entries are durable two seconds after it was given them, but for the first 800.
[[nodiscard]] std::unique_ptr<store::ScanLog> tiring_log(std::unique_ptr<store::ScanLog> log);

/// One of them by its name: "hasty", "forgetful", "blind", "misled", "leaky" or "tiring". Another name breaks nothing.
[[nodiscard]] std::unique_ptr<store::ScanLog> broken_log(std::string_view kind, std::unique_ptr<store::ScanLog> log);

} // namespace scanloom::fault
