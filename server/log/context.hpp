#pragma once

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <utility>

/// Lines of the log that say, besides their sentence, whom they are about: a sentence for people, fields for programs.
namespace scanloom::log {

/// Empty where it is about none, or not known.
struct Context {
    std::string_view session{};
    std::string_view robot{};
    std::string_view peer{}; ///< address, perhaps with a port
};

/// That of the line which this thread is writing at the moment, for formatters.
[[nodiscard]] const Context& current() noexcept;

namespace detail {

/// As long as it lives, this is the context of what its thread writes.
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

} // namespace scanloom::log
