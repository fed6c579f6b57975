#pragma once

#include <spdlog/formatter.h>

#include <memory>

namespace scanloom::log {

/// A line of the log as an object of JSON: "time" (RFC 3339, UTC, milliseconds), "level", "message"; and "session",
/// "robot", "peer", where the line is about one.
/// Thread  one at a time; it writes what current() is on the thread that logs.
class JsonFormatter final : public spdlog::formatter {
public:
    void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& into) override;
    [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override;
};

} // namespace scanloom::log
