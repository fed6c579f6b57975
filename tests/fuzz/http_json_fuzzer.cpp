#include "common/json/json_text.hpp"
#include "server/http/json_read.hpp"
#include "tests/fuzz/check.hpp"

#include <cmath>
#include <cstdint>

/// Input: the body of a request.
SCANLOOM_FUZZER(http_json)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const auto object = http::parse_json_object({reinterpret_cast<const char*>(data), size});
    if (!object) {
        fuzz::check(!object.error().message.empty(), "every error has a message");
        return 0;
    }
    static_cast<void>(http::read_text(*object, "name"));
    const auto number = http::read_number(*object, "cell_size");
    if (number && *number) fuzz::check(std::isfinite(**number), "numbers are finite");
    fuzz::check(http::parse_json_object(json_text(*object)).has_value(), "a written object can be parsed");
    return 0;
}
