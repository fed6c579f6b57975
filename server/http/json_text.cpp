#include "server/http/json_text.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace scanloom::http {
namespace {

void append(std::string& text, const boost::json::value& value);

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
        fmt::format_to(std::back_inserter(text), "{}", value.get_double());
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

} // namespace scanloom::http
