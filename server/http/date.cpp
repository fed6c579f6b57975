#include "server/http/date.hpp"

#include <fmt/chrono.h>

namespace scanloom::http {

std::string date_of(std::time_t time) { return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT", fmt::gmtime(time)); }

std::string_view date_now() {
    thread_local std::time_t written = 0;
    thread_local std::string text;
    const std::time_t now = std::time(nullptr);
    if (now != written || text.empty()) text = date_of(written = now);
    return text;
}

} // namespace scanloom::http
