#pragma once

namespace scanloom {

/// Opens /dev/null as standard input, output or error if the program was started with it closed. Otherwise the next
/// file or socket would get its number and receive what is printed. Call it before anything else in main().
/// Errors: throws std::system_error if /dev/null cannot be opened.
void open_missing_standard_streams();

} // namespace scanloom
