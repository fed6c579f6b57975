#pragma once

#include <fmt/format.h>
#include <spdlog/formatter.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string_view>
#include <utility>

/// Writes log lines that have a sentence for people and, for programs, fields with the session, robot and peer.

namespace scanloom::log {

/// The session, robot and peer of a log line. A field is empty if it does not apply or is unknown.
struct Context {
    std::string_view session{};
    std::string_view robot{};
    std::string_view peer{}; ///< address, optionally with a port
};

/// Returns the context of the line that the calling thread is writing. For formatters.
[[nodiscard]] const Context& current() noexcept;

namespace detail {

/// Sets the context of the calling thread's log lines for the lifetime of the scope.
class Scope {
public:
    explicit Scope(const Context& context) noexcept;
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

private:
    const Context* before_;
};

template <class... Args>
void write(spdlog::level::level_enum level, const Context& context, fmt::format_string<Args...> format,
           Args&&... args) {
    const Scope scope(context);
    spdlog::default_logger_raw()->log(level, format, std::forward<Args>(args)...);
}

} // namespace detail

/// Logs a line of level info with the fields of `context`. Threads: any thread; warn() and error() likewise.
template <class... Args>
void info(const Context& context, fmt::format_string<Args...> format, Args&&... args) {
    detail::write(spdlog::level::info, context, format, std::forward<Args>(args)...);
}

template <class... Args>
void warn(const Context& context, fmt::format_string<Args...> format, Args&&... args) {
    detail::write(spdlog::level::warn, context, format, std::forward<Args>(args)...);
}

template <class... Args>
void error(const Context& context, fmt::format_string<Args...> format, Args&&... args) {
    detail::write(spdlog::level::err, context, format, std::forward<Args>(args)...);
}

/// Formats a log line as a JSON object: "time" (RFC 3339, UTC, milliseconds), "level" and "message", and those of
/// "session", "robot" and "peer" that are not empty.
/// Threads: one at a time; uses current() of the thread that logs.
class JsonFormatter final : public spdlog::formatter {
public:
    void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& into) override;
    [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override;
};

} // namespace scanloom::log
