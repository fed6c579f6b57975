#include "common/json/json_text.hpp"

#include <array>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>

namespace scanloom {
namespace {

void append(std::string& text, const boost::json::value& value);

/// Appends a finite number.
void append(std::string& text, double number) {
    const double size = std::abs(number);
    const bool is_plain = size == 0.0 || (1e-6 <= size && size < 1e21);
    std::array<char, 40> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number,
                                   is_plain ? std::chars_format::fixed : std::chars_format::scientific);
    text.append(digits.data(), end.ptr);
}

void append(std::string& text, const boost::json::object& object) {
    text += '{';
    const char* separator = "";
    for (const auto& [key, value] : object) {
        text += separator;
        text += boost::json::serialize(key);
        text += ':';
        append(text, value);
        separator = ",";
    }
    text += '}';
}

void append(std::string& text, const boost::json::array& array) {
    text += '[';
    const char* separator = "";
    for (const auto& value : array) {
        text += separator;
        append(text, value);
        separator = ",";
    }
    text += ']';
}

void append(std::string& text, const boost::json::value& value) {
    if (value.is_object()) return append(text, value.get_object());
    if (value.is_array()) return append(text, value.get_array());
    if (!value.is_double()) {
        text += boost::json::serialize(value);
    } else if (std::isfinite(value.get_double())) {
        append(text, value.get_double());
    } else {
        text += "null";
    }
}

} // namespace

std::string json_text(const boost::json::value& value) {
    std::string text;
    append(text, value);
    return text;
}

} // namespace scanloom
