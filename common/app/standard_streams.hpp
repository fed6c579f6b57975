#pragma once

namespace scanloom {

/// Opens /dev/null in the place of standard input, output and error where they came closed. Otherwise the next file or
/// socket would take their numbers, and what is printed would go into it. Call it before anything else in main().
/// Throws std::system_error where that cannot be done.
void open_missing_standard_streams();

} // namespace scanloom
