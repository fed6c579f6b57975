#include "server/http/header_fields.hpp"
#include "server/http/target.hpp"
#include "tests/fuzz/check.hpp"

#include <cstdint>

namespace scanloom::http {
namespace {

/// Checks the properties of every segment that parse_target() accepts.
void check_segments(const std::vector<std::string>& segments) {
    for (const auto& segment : segments) {
        fuzz::check(segment != "." && segment != "..", "no segment is a relative path");
        fuzz::check(segment.find_first_of(std::string_view("/\\\0", 3)) == std::string::npos,
                    "no segment contains a separator");
    }
}

} // namespace
} // namespace scanloom::http

/// Input: a request target; also parsed as the fields If-None-Match and Host.
SCANLOOM_FUZZER(http_target)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    static_cast<void>(http::if_none_match_has(text, "\"a-1\""));
    static_cast<void>(http::is_known_host(text, {"maps.example"}));

    const auto target = http::parse_target(text);
    if (!target) {
        fuzz::check(!target.error().message.empty(), "every error has a message");
        return 0;
    }
    fuzz::check(!target->segments.empty(), "every path has a segment");
    http::check_segments(target->segments);
    static_cast<void>(target->query.check_only({"since", "layer"}));
    const auto arguments =
        http::match_path("/api/v1/sessions/{session}/tiles/{layer}/{z}/{x}/{y}.png", target->segments);
    if (arguments) {
        fuzz::check(!(*arguments)["session"].empty() && !(*arguments)["y"].empty(), "arguments are not empty");
    }
    return 0;
}
