#include "server/app/standard_error_sink.hpp"

#include "common/app/standard_streams.hpp"
#include "server/auth/token.hpp"

#include <spdlog/sinks/base_sink.h>

#include <mutex>
#include <string_view>

namespace scanloom::app {
namespace {

std::string_view colour_of(spdlog::level::level_enum level) {
    if (level >= spdlog::level::err) return "\x1b[31m";
    if (level == spdlog::level::warn) return "\x1b[33m";
    return "\x1b[32m";
}

class StandardErrorSink final : public spdlog::sinks::base_sink<std::mutex> {
    void sink_it_(const spdlog::details::log_msg& message) override {
        spdlog::memory_buf_t text;
        formatter_->format(message, text);
        const auto plain =
            auth::without_secrets({text.data(), text.size()}); // a client may have sent one in a logged field
        if (!standard_error().is_terminal()) {
            standard_error().write(plain);
            return;
        }
        const auto begin = message.color_range_start; // the range is before the message, and so before any secret
        const auto end = message.color_range_end;
        standard_error().write(fmt::format("{}{}{}\x1b[0m{}", plain.substr(0, begin), colour_of(message.level),
                                           plain.substr(begin, end - begin), plain.substr(end)));
    }

    void flush_() override {} // lines are not buffered here
};

} // namespace

spdlog::sink_ptr standard_error_sink() { return std::make_shared<StandardErrorSink>(); }

} // namespace scanloom::app
