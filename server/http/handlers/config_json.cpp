#include "server/http/handlers/config_json.hpp"

#include <boost/json/value.hpp>

#include <cstdint>
#include <string_view>
#include <variant>

namespace scanloom::http {
namespace {

/// Converts a value to the type that a configuration field accepts. A value of no such type becomes an empty string.
mapping::ConfigValue config_value(const boost::json::value& json) {
    if (json.is_bool()) return json.get_bool();
    if (json.is_string()) return std::string_view(json.get_string());
    boost::system::error_code not_whole;
    if (const auto whole = json.to_number<std::int32_t>(not_whole); !not_whole) return whole;
    boost::system::error_code no_number;
    if (const auto number = json.to_number<double>(no_number); !no_number) return number;
    return std::string_view();
}

boost::json::value to_json(const mapping::ConfigValue& value) {
    return std::visit([](const auto& held) { return boost::json::value(held); }, value);
}

} // namespace

boost::json::object to_json(const mapping::MapConfig& config) {
    boost::json::object json;
    for (const auto& field : mapping::config_fields()) json[field.name] = to_json(mapping::value_of(field, config));
    return json;
}

Result<> read_options(const boost::json::object& object, SessionOptions& options) {
    for (const auto& field : mapping::config_fields()) {
        const auto* given = object.if_contains(field.name);
        if (given == nullptr) continue;
        if (auto set = mapping::set_option(options, field, config_value(*given)); !set) return set.error();
    }
    return {};
}

} // namespace scanloom::http
