#pragma once

namespace scanloom::app {

/// Does the task that the arguments of the program name, and logs to standard error: serves until a signal ends it, or
/// checks, repairs, restores or copies a store.
/// @return exit code of the program
[[nodiscard]] int run(int argc, const char* const* argv);

} // namespace scanloom::app
