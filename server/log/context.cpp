#include "server/log/context.hpp"

#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/chrono.h>

#include <chrono>
#include <string>

namespace scanloom::log {
namespace {

constexpr Context kNone;
thread_local const Context* of_this_thread = &kNone;

} // namespace

const Context& current() noexcept { return *of_this_thread; }

namespace detail {

Scope::Scope(const Context& context) noexcept : before_(std::exchange(of_this_thread, &context)) {}
Scope::~Scope() { of_this_thread = before_; }

} // namespace detail

namespace {

std::string rfc3339(std::chrono::system_clock::time_point time) {
    const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
    const auto millis = std::chrono::duration_cast<std::chrono::milliseconds>(time - seconds).count();
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                       millis);
}

std::string_view view(spdlog::string_view_t text) { return {text.data(), text.size()}; }

} // namespace

void JsonFormatter::format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& into) {
    boost::json::object object{{"time", rfc3339(line.time)},
                               {"level", view(spdlog::level::to_string_view(line.level))},
                               {"message", view(line.payload)}};
    const Context& about = current();
    if (!about.session.empty()) object["session"] = about.session;
    if (!about.robot.empty()) object["robot"] = about.robot;
    if (!about.peer.empty()) object["peer"] = about.peer;
    const std::string text = boost::json::serialize(object) + '\n';
    into.append(text.data(), text.data() + text.size());
}

std::unique_ptr<spdlog::formatter> JsonFormatter::clone() const { return std::make_unique<JsonFormatter>(); }

} // namespace scanloom::log
