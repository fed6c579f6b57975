#pragma once

#include <spdlog/common.h>

namespace scanloom::app {

/// The log on standard_error(): no thread ever waits for whoever should read it. The level is coloured on a terminal.
[[nodiscard]] spdlog::sink_ptr standard_error_sink();

} // namespace scanloom::app
