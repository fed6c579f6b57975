#include "server/http/multipart.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

/// Input: a Content-Type field, a line feed, the body of a request.
SCANLOOM_FUZZER(http_form)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const auto type = input.substr(0, input.find('\n'));
    const auto body = input.substr(std::min(input.size(), type.size() + 1));
    const auto fields = http::parse_form(type, body);
    if (!fields) {
        fuzz::check(!fields.error().message.empty(), "every error has a message");
        return 0;
    }
    fuzz::check(fields->size() <= http::kFormFieldsMax, "fields are bounded");
    for (const auto& field : *fields) {
        fuzz::check(!field.name.empty(), "every field has a name");
        const bool lies_in_body =
            field.content.empty() || (field.content.data() >= body.data() &&
                                      field.content.data() + field.content.size() <= body.data() + body.size());
        fuzz::check(lies_in_body, "contents are parts of the body");
    }
    return 0;
}
