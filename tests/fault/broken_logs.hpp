#pragma once

#include "server/store/scan_log.hpp"

#include <memory>
#include <string_view>

/// Scan logs that each break one guarantee. The rows of faults must detect them.
namespace scanloom::fault {

/// Reports entries as durable and writes them later in groups, so that a crash loses some.
[[nodiscard]] std::unique_ptr<store::ScanLog> hasty_log(std::unique_ptr<store::ScanLog> log);

/// Appends some batches twice, as if it forgot that they were stored.
[[nodiscard]] std::unique_ptr<store::ScanLog> forgetful_log(std::unique_ptr<store::ScanLog> log);

/// Reads scans that differ from the written ones without an error, as a store without checksums may.
[[nodiscard]] std::unique_ptr<store::ScanLog> blind_log(std::unique_ptr<store::ScanLog> log);

/// Acknowledges entries as duplicates without storing them while the wall clock shows an earlier time than when it was
/// opened.
[[nodiscard]] std::unique_ptr<store::ScanLog> misled_log(std::unique_ptr<store::ScanLog> log);

/// Leaks 64 KiB of memory for each entry.
[[nodiscard]] std::unique_ptr<store::ScanLog> leaky_log(std::unique_ptr<store::ScanLog> log);

/// Reports entries as durable two seconds after it received them, except for the first 800.
[[nodiscard]] std::unique_ptr<store::ScanLog> tiring_log(std::unique_ptr<store::ScanLog> log);

/// Returns the log with this name: "hasty", "forgetful", "blind", "misled", "leaky" or "tiring". Another name returns
/// `log` unchanged.
[[nodiscard]] std::unique_ptr<store::ScanLog> broken_log(std::string_view kind, std::unique_ptr<store::ScanLog> log);

} // namespace scanloom::fault
