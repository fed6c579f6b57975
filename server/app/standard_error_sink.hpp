#pragma once

#include <spdlog/common.h>

namespace scanloom::app {

/// Returns a log sink that writes to standard_error(), so that no thread waits for the reader of the log. It removes
/// secrets from the lines, and colours the level if standard error is a terminal.
[[nodiscard]] spdlog::sink_ptr standard_error_sink();

} // namespace scanloom::app
