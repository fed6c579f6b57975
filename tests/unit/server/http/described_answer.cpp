#include "tests/unit/server/http/described_answer.hpp"

#include "common/json/json_text.hpp"
#include "server/http/openapi.hpp"
#include "server/http/routes.hpp"
#include "server/http/target.hpp"
#include "tests/unit/server/http/api_description.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <variant>

namespace scanloom::http {
namespace {

namespace json = boost::json;

/// The permitted and the required fields of an object, including those of the schemas in its allOf.
struct Fields {
    std::map<std::string, const json::value*> named;
    std::set<std::string> required;
    const json::value* others = nullptr; // schema of all other fields
};

void collect(const json::object& schema, Fields& fields) {
    if (const auto* all = schema.if_contains("allOf")) {
        for (const auto& one : all->as_array()) collect(resolved(one), fields);
    }
    if (const auto* named = schema.if_contains("properties")) {
        for (const auto& field : named->as_object()) fields.named[std::string(field.key())] = &field.value();
    }
    if (const auto* required = schema.if_contains("required")) {
        for (const auto& name : required->as_array()) fields.required.insert(std::string(name.as_string()));
    }
    if (const auto* others = schema.if_contains("additionalProperties"); others != nullptr && others->is_object()) {
        fields.others = others;
    }
}

bool has_type(const json::value& value, std::string_view type) {
    if (type == "string") return value.is_string();
    if (type == "integer") return value.is_int64() || value.is_uint64();
    if (type == "number") return value.is_number();
    if (type == "boolean") return value.is_bool();
    if (type == "array") return value.is_array();
    return type == "object" && value.is_object();
}

using Faults = std::vector<std::string>;

Faults faults_of(const json::value& schema_or_reference, const json::value& value, const std::string& where);

Faults faults_of_object(const json::object& schema, const json::object& object, const std::string& where) {
    Fields fields;
    collect(schema, fields);
    Faults faults;
    for (const auto& name : fields.required) {
        if (!object.contains(name)) faults.push_back(fmt::format("{}.{} is missing", where, name));
    }
    if (fields.named.empty() && fields.others == nullptr) return faults; // any object is valid
    for (const auto& field : object) {
        const std::string name(field.key());
        const auto named = fields.named.find(name);
        const auto* described = named == fields.named.end() ? fields.others : named->second;
        if (described == nullptr) {
            faults.push_back(fmt::format("{}.{} is not described", where, name));
            continue;
        }
        std::ranges::move(faults_of(*described, field.value(), where + "." + name), std::back_inserter(faults));
    }
    return faults;
}

Faults faults_of(const json::value& schema_or_reference, const json::value& value, const std::string& where) {
    const auto& schema = resolved(schema_or_reference);
    if (value.is_null() && schema.contains("nullable")) return {};
    if (const auto* alternatives = schema.if_contains("oneOf")) {
        Faults faults;
        for (const auto& alternative : alternatives->as_array()) {
            auto of_this = faults_of(alternative, value, where);
            if (of_this.empty()) return {};
            std::ranges::move(of_this, std::back_inserter(faults));
        }
        return faults;
    }
    const auto* type = schema.if_contains("type");
    if (type != nullptr && !has_type(value, type->as_string())) {
        return {fmt::format("{} is no {}", where, std::string_view(type->as_string()))};
    }
    const auto* possible = schema.if_contains("enum");
    if (possible != nullptr && std::ranges::find(possible->as_array(), value) == possible->as_array().end()) {
        return {fmt::format("{} has a value that is not described", where)};
    }
    if (value.is_object()) return faults_of_object(schema, value.get_object(), where);
    Faults faults;
    if (const auto* items = schema.if_contains("items"); items != nullptr && value.is_array()) {
        for (const auto& item : value.get_array()) {
            std::ranges::move(faults_of(*items, item, where + "[]"), std::back_inserter(faults));
        }
    }
    return faults;
}

/// Returns the description of the operation of the request, or null if there is none.
const json::object* operation_of(const Request& request) {
    const auto target = parse_target(request.target);
    if (!target) return nullptr;
    const auto found = find_route(routes(), request.method, target->segments);
    const auto* match = std::get_if<Match>(&found);
    if (match == nullptr) return nullptr;
    const auto name = name_of(match->route.method);
    const auto* const method = name == "GET" ? "get" : name == "POST" ? "post" : "delete";
    return &described_api().at("paths").at(match->route.path).at(method).as_object();
}

Faults faults_of_body(const json::object& described, const Response& response) {
    const auto* content = described.if_contains("content");
    if (content == nullptr) {
        return response.body.bytes().empty() ? Faults{} : Faults{"there is a body, but none is described"};
    }
    const auto field = response.get("Content-Type");
    const auto type = field.substr(0, field.find(';'));
    if (content->as_object().contains("*/*")) return {};
    const auto* media = content->as_object().if_contains(type);
    if (media == nullptr) return {fmt::format("{} is not described", type)};
    if (!type.ends_with("json")) return {};
    return faults_of(media->at("schema"), json::parse(response.body.bytes()), "body");
}

} // namespace

const json::value& described_api() {
    static const json::value whole = json::parse(json_text(openapi()));
    return whole;
}

const json::object& resolved(const json::value& value) {
    const auto* reference = value.as_object().if_contains("$ref");
    if (reference == nullptr) return value.as_object();
    return described_api().at_pointer(std::string_view(reference->as_string()).substr(1)).as_object();
}

std::vector<std::string> undescribed(const Request& request, const Response& response) {
    const auto* operation = operation_of(request);
    if (operation == nullptr) {
        const json::value problem{{"$ref", "#/components/schemas/Problem"}};
        return faults_of(problem, json::parse(response.body.bytes()), "problem");
    }
    const auto status = std::to_string(static_cast<unsigned>(response.status));
    const auto* described = operation->at("responses").as_object().if_contains(status);
    auto faults = described == nullptr ? Faults{fmt::format("status {} is not described", status)}
                                       : faults_of_body(resolved(*described), response);
    for (auto& fault : faults) fault = fmt::format("{} {}: {}", request.method, request.target, fault);
    return faults;
}

} // namespace scanloom::http
