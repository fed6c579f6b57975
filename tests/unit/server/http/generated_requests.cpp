#include "tests/unit/server/http/generated_requests.hpp"

#include "tests/unit/server/http/api_description.hpp"

#include <boost/json/array.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <array>
#include <iterator>

namespace scanloom::http {
namespace {

namespace json = boost::json;

using namespace std::string_view_literals;

/// Names of existing sessions and robots, and invalid names.
constexpr std::array kNames = {"lab"sv, "lab"sv, "lab"sv, "r1"sv, "new"sv, "none"sv};
constexpr std::array kOddTexts = {""sv,       " "sv,    "NaN"sv,     "-0"sv,       "1e999"sv,
                                  "0x10"sv,   "null"sv, "..%2f.."sv, "\xff\xfe"sv, "\0"sv,
                                  "Zürich"sv, "a b"sv,  "true"sv,    "1,2"sv,      "9999999999999999999"sv};

/// Percent-encodes all but letters, digits and the separators of numbers in queries.
std::string encoded(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
                              c == '_' || c == '.' || c == ',';
        if (is_plain) {
            out += c;
        } else {
            fmt::format_to(std::back_inserter(out), "%{:02X}", static_cast<unsigned char>(c));
        }
    }
    return out;
}

double number_at(const json::object& schema, std::string_view name, double otherwise) {
    const auto* value = schema.if_contains(name);
    return value == nullptr ? otherwise : value->to_number<double>();
}

} // namespace

Request RequestGenerator::next() {
    const auto& paths = described_api().at("paths").as_object();
    const auto path = std::next(paths.begin(), static_cast<std::ptrdiff_t>(random_() % paths.size()));
    const auto& operations = path->value().as_object();
    const auto operation = std::next(operations.begin(), static_cast<std::ptrdiff_t>(random_() % operations.size()));
    Request request;
    request.method = operation->key() == "get" ? "GET" : operation->key() == "post" ? "POST" : "DELETE";
    if (request.method == "GET" && one_in(16)) request.method = "HEAD";
    if (one_in(64)) request.method = any_of(std::array{"PUT", "PATCH", "OPTIONS", "get", ""});
    request.target = target_for(path->key(), operation->value().as_object());
    const auto* body = operation->value().as_object().if_contains("requestBody");
    if (body == nullptr) {
        if (one_in(32)) request.body = "{}";
        return request;
    }
    const auto& content = *resolved(*body).at("content").as_object().begin();
    request.content_type = content.key();
    request.body = content.key() == "application/json" ? json_body(content.value().at("schema")) : form_body();
    if (content.key() != "application/json") request.content_type += "; boundary=b";
    if (one_in(32))
        request.content_type = any_of(std::array{"", "text/plain", "application/json; charset=latin1", "a"});
    return request;
}

std::string RequestGenerator::target_for(std::string_view pattern, const json::object& operation) {
    std::string target(pattern);
    std::string query;
    const auto add = [&](std::string_view name, std::string_view value) {
        query += fmt::format("{}{}={}", query.empty() ? "?" : "&", name, encoded(value));
    };
    const auto* parameters = operation.if_contains("parameters");
    const std::size_t count = parameters == nullptr ? 0 : parameters->as_array().size();
    for (std::size_t n = 0; n < count; ++n) {
        const auto& parameter = resolved(parameters->as_array()[n]);
        const std::string_view name = parameter.at("name").as_string();
        const auto& in = parameter.at("in").as_string();
        if (in == "path") {
            const auto braced = fmt::format("{{{}}}", name);
            target.replace(target.find(braced), braced.size(), path_value(name, parameter.at("schema")));
        } else if (in == "query" && one_in(count > 8 ? 12 : 2)) {
            add(name, text_of(parameter.at("schema")));
            if (one_in(32)) add(name, text_of(parameter.at("schema")));
        }
    }
    if (one_in(32)) add("unknown", "1");
    return target + query;
}

std::string RequestGenerator::path_value(std::string_view name, const json::value& schema) {
    if (one_in(12)) return encoded(any_of(kOddTexts));
    if (name == "session") return std::string(any_of(kNames));
    return encoded(text_of(schema));
}

/// Formats a value for a query: lists with commas.
std::string RequestGenerator::text_of(const json::value& schema) {
    const auto value = value_of(schema);
    if (value.is_string()) return std::string(value.as_string());
    auto text = json::serialize(value);
    if (value.is_array()) text = text.substr(1, text.size() - 2);
    return text;
}

json::value RequestGenerator::value_of(const json::value& schema_or_reference, int depth) {
    if (one_in(16) || depth > 6) return wrong_value();
    const auto& schema = resolved(schema_or_reference);
    for (const auto* choice : {"oneOf", "anyOf"}) {
        if (const auto* of = schema.if_contains(choice)) return value_of(any_of(of->as_array()), depth + 1);
    }
    if (const auto* values = schema.if_contains("enum")) return any_of(values->as_array());
    const auto* type = schema.if_contains("type");
    const std::string_view name = type == nullptr ? "object" : std::string_view(type->as_string());
    if (name == "integer" || name == "number") return number_of(schema, name == "integer");
    if (name == "string") return string_of(schema);
    if (name == "boolean") return one_in(2);
    if (name == "array") return array_of(schema, depth);
    return object_of(schema, depth);
}

json::value RequestGenerator::wrong_value() {
    switch (random_() % 6) {
    case 0: return nullptr;
    case 1: return json::string(any_of(kOddTexts));
    case 2: return 1e308;
    case 3: return json::array{1, "2", nullptr};
    case 4: return json::object{{"a", 1}};
    default: return -7;
    }
}

json::value RequestGenerator::number_of(const json::object& schema, bool is_whole) {
    const double least = number_at(schema, "minimum", -1e6);
    const double most = number_at(schema, "maximum", is_whole ? 1e6 : 1e3);
    const double step = is_whole ? 1.0 : 0.001;
    const std::array values = {least, most, least - step, most + step, least + step, (least + most) / 2,
                               0.0,   1.0,  2.0,          3.0};
    const double value = any_of(values);
    if (is_whole) return static_cast<std::int64_t>(value);
    return value;
}

json::value RequestGenerator::string_of(const json::object& schema) {
    if (const auto* format = schema.if_contains("format"); format != nullptr && format->as_string() == "binary") {
        return "P5";
    }
    return json::string(one_in(6) ? any_of(kOddTexts) : any_of(kNames));
}

json::value RequestGenerator::array_of(const json::object& schema, int depth) {
    const auto least = static_cast<std::size_t>(number_at(schema, "minItems", 0));
    std::size_t size = least + random_() % 4;
    if (const auto* most = schema.if_contains("maxItems"); most != nullptr && !one_in(8)) {
        size = std::min(size, static_cast<std::size_t>(most->to_number<std::int64_t>()));
    }
    if (one_in(16)) size = 0;
    json::array items;
    for (std::size_t n = 0; n < size; ++n) items.push_back(value_of(schema.at("items"), depth + 1));
    return items;
}

json::object RequestGenerator::object_of(const json::object& schema, int depth) {
    json::object object;
    if (const auto* all = schema.if_contains("allOf")) {
        for (const auto& one : all->as_array()) {
            for (auto& field : object_of(resolved(one), depth + 1)) object[field.key()] = std::move(field.value());
        }
    }
    const auto* fields = schema.if_contains("properties");
    if (fields == nullptr) return object;
    const auto* required = schema.if_contains("required");
    const auto count = static_cast<unsigned>(fields->as_object().size());
    for (const auto& field : fields->as_object()) {
        const bool is_required = required != nullptr &&
                                 std::ranges::any_of(required->as_array(),
                                                     [&](const auto& name) { return name.as_string() == field.key(); });
        if (is_required ? one_in(32) : !one_in(count > 8 ? 8 : 2)) continue;
        object[field.key()] = value_of(field.value(), depth + 1);
    }
    if (one_in(32)) object["unknown"] = 1;
    return object;
}

std::string RequestGenerator::json_body(const json::value& schema) {
    switch (random_() % 48) {
    case 0: return "";
    case 1: return "[";
    case 2: return "null";
    case 3: return std::string(2'000, '[');
    default: return json::serialize(value_of(schema));
    }
}

/// Returns a map to import, sometimes damaged.
std::string RequestGenerator::form_body() {
    const std::array images = {"P2\n4 2\n255\n0 254 254 205\n254 254 254 254\n"sv,
                               "P2\n2 1\n1\n0 1\n"sv,
                               "P5\n9 9\n255\n"sv,
                               "P2\n70000 70000\n255\n"sv,
                               "\x89PNG"sv,
                               ""sv};
    const std::array descriptions = {"image: map.pgm\nresolution: 0.1\norigin: [-0.2, 0, 0]\n"sv,
                                     "image: map.pgm\nresolution: 0.02\norigin: [0, 0, 0]\nnegate: no\n"sv,
                                     "image: map.pgm\nresolution: 0\norigin: [0, 0, 0]\n"sv,
                                     "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0.5]\n"sv,
                                     "[a"sv,
                                     ""sv};
    const auto field = [](std::string_view name, std::string_view content) {
        return fmt::format("--b\r\nContent-Disposition: form-data; name=\"{}\"\r\n\r\n{}\r\n", name, content);
    };
    std::string body;
    if (!one_in(16)) body += field("yaml", one_in(2) ? descriptions[0] : any_of(descriptions));
    if (!one_in(16)) body += field("image", one_in(2) ? images[0] : any_of(images));
    if (one_in(4)) body += field("cell_size", any_of(std::array{"0.1"sv, "0.01"sv, "7"sv, ""sv, "x"sv}));
    if (one_in(16)) body += field("unknown", "1");
    body += "--b--\r\n";
    if (one_in(16)) body.resize(random_() % body.size());
    return body;
}

} // namespace scanloom::http
