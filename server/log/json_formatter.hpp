#pragma once

#include <spdlog/formatter.h>

#include <memory>

namespace scanloom::log {

/// Formats a log line as a JSON object: "time" (RFC 3339, UTC, milliseconds), "level" and "message", and those of
/// "session", "robot" and "peer" that are not empty.
/// Threads: one at a time; uses current() of the thread that logs.
class JsonFormatter final : public spdlog::formatter {
public:
    void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& into) override;
    [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override;
};

} // namespace scanloom::log
