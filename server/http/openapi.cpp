#include "server/http/openapi.hpp"

#include "core/mapping/map_config.hpp"
#include "server/http/openapi_text.hpp"
#include "server/http/routes.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::http {

namespace json = boost::json;

namespace {

/// Returns the help text of a setting, with its unit in parentheses at the end of the first clause.
std::string help_with_unit(const mapping::ConfigField& field) {
    std::string text = field.help;
    if (*field.unit != '\0') text.insert(text.find_first_of(".;"), fmt::format(" ({})", field.unit));
    return text;
}

json::object schema_of(const mapping::ConfigField& field) {
    json::object schema;
    const auto initial = mapping::value_of(field, {});
    if (std::holds_alternative<bool>(initial)) schema = {{"type", "boolean"}};
    if (std::holds_alternative<std::int32_t>(initial)) schema = {{"type", "integer"}, {"format", "int32"}};
    if (std::holds_alternative<double>(initial)) schema = {{"type", "number"}, {"format", "double"}};
    if (std::holds_alternative<std::string_view>(initial)) schema = {{"type", "string"}};
    const auto choices = mapping::choices_of(field);
    if (!choices.empty()) schema["enum"] = json::array(choices.begin(), choices.end());
    const auto& bounds = field.bounds;
    if (std::isfinite(bounds.low)) schema["minimum"] = bounds.low;
    if (std::isfinite(bounds.high)) schema["maximum"] = bounds.high;
    if (bounds.low_is_excluded) schema["exclusiveMinimum"] = true;
    if (bounds.high_is_excluded) schema["exclusiveMaximum"] = true;
    return schema;
}

void add_settings(json::object& components) {
    auto& schemas = components["schemas"].as_object();
    json::array names;
    for (const auto& field : mapping::config_fields()) {
        auto schema = schema_of(field);
        components["parameters"].as_object()[field.name] = {
            {"name", field.name},
            {"in", "query"},
            {"required", false},
            {"description", help_with_unit(field) + " The maps are computed again from the log with it."},
            {"schema", schema}};
        schema["description"] = help_with_unit(field);
        for (const char* name : {"SessionRequest", "SessionConfig", "WeaveRequest"})
            schemas[name].at("properties").as_object()[field.name] = schema;
        schemas["SessionRequest"].at("properties").at(field.name).as_object()["default"] =
            std::visit([](auto initial) { return json::value(initial); }, mapping::value_of(field, {}));
        names.emplace_back(field.name);
    }
    schemas["SessionConfig"].as_object()["required"] = std::move(names);
}

/// Refers to the component that describes a parameter.
/// @param own  names of components that are preferred
json::object parameter(const json::object& components, const json::array& own, std::string_view in,
                       std::string_view name) {
    std::vector<std::string_view> candidates;
    for (const auto& component : own) candidates.push_back(component.as_string());
    for (const auto& component : components) candidates.push_back(component.key());
    const auto found = std::ranges::find_if(candidates, [&](std::string_view candidate) {
        const auto& component = components.at(candidate);
        return component.at("in").as_string() == in && component.at("name").as_string() == name;
    });
    if (found == candidates.end()) throw std::logic_error(fmt::format("openapi.yaml has no parameter {}", name));
    return {{"$ref", fmt::format("#/components/parameters/{}", *found)}};
}

std::vector<std::string_view> variables_of(std::string_view pattern) {
    std::vector<std::string_view> names;
    for (auto open = pattern.find('{'); open != pattern.npos; open = pattern.find('{', open + 1))
        names.push_back(pattern.substr(open + 1, pattern.find('}', open) - open - 1));
    return names;
}

json::array parameters_of(const Route& route, const json::object& operation, const json::object& components) {
    json::array own;
    if (const auto* given = operation.if_contains("parameters")) own = given->as_array();
    json::array parameters;
    for (const auto name : variables_of(route.path)) parameters.push_back(parameter(components, own, "path", name));
    if (takes_any_parameter(route)) return parameters;
    for (const auto name : route.parameters) parameters.push_back(parameter(components, own, "query", name));
    return parameters;
}

/// Returns the statuses with which the server may answer any request for such a route.
std::vector<const char*> common_statuses(const Route& route) {
    std::vector<const char*> statuses;
    if (!takes_any_parameter(route)) statuses.push_back("400");
    if (route.access != Access::kOpen) statuses.insert(statuses.end(), {"401", "403"});
    if (route.path.find('{') != route.path.npos) statuses.push_back("404");
    if (name_of(route.method) == "POST") statuses.insert(statuses.end(), {"413", "415"});
    if (route.sessions == Sessions::kLoaded) statuses.push_back("500");
    if (route.sessions != Sessions::kUnused) statuses.push_back("503");
    return statuses;
}

json::object operation_of(const Route& route, const json::object& source, const json::object& components) {
    const auto* described = source.at("operations").as_object().if_contains(route.name);
    if (described == nullptr) throw std::logic_error(fmt::format("openapi.yaml has no operation {}", route.name));
    auto operation = described->as_object();
    operation["operationId"] = route.name;
    auto parameters = parameters_of(route, operation, components);
    auto& responses = operation["responses"].as_object();
    if (responses.contains("304")) parameters.push_back(parameter(components, {}, "header", "If-None-Match"));
    operation.erase("parameters");
    if (!parameters.empty()) operation["parameters"] = std::move(parameters);
    for (const auto* status : common_statuses(route)) responses.emplace(status, source.at("statuses").at(status));
    if (route.access == Access::kOpen) operation.emplace("security", json::array());
    return operation;
}

const char* member_of(Method method) {
    switch (method) {
    case Method::kGet: return "get";
    case Method::kPost:
    case Method::kPostForm: return "post";
    case Method::kDelete: return "delete";
    }
    return "";
}

/// Throws std::exception if an operation, a parameter or a status has no entry in openapi.yaml, or an entry no
/// operation.
json::object description_of(std::span<const Route> routes) {
    const auto source = json::parse(kOpenapiText).as_object();
    auto document = source.at("document").as_object();
    auto& components = document["components"].as_object();
    add_settings(components);
    const auto& parameters = components.at("parameters").as_object();
    json::object paths;
    for (const auto& route : routes) {
        auto& path = paths[route.path];
        if (path.is_null()) path.emplace_object();
        path.get_object()[member_of(route.method)] = operation_of(route, source, parameters);
    }
    document["paths"] = std::move(paths);
    if (source.at("operations").as_object().size() != routes.size())
        throw std::logic_error("openapi.yaml describes an operation that is not in the table of routes");
    return document;
}

} // namespace

const json::object& openapi() {
    static const json::object document = description_of(routes());
    return document;
}

} // namespace scanloom::http
