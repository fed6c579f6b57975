#include "core/mapping/map_config.hpp"
#include "tests/unit/server/http/api_description.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

/// The settings of a session in openapi.json agree with the table common/scan/settings.def.
namespace scanloom::http {
namespace {

namespace json = boost::json;

constexpr const char* kSchemasWithSettings[] = {"SessionRequest", "SessionConfig", "WeaveRequest"};

const json::object& component(const char* kind, std::string_view name) {
    return described_api().at("components").at(kind).at(name).as_object();
}

/// Returns the help text of a setting, with its unit in parentheses at the end of the first clause.
std::string description_with_unit(const mapping::ConfigField& field) {
    std::string text = field.help;
    if (*field.unit != '\0') text.insert(text.find_first_of(".;"), fmt::format(" ({})", field.unit));
    return text;
}

bool is_true(const json::object& schema, std::string_view member) {
    const auto* value = schema.if_contains(member);
    return value != nullptr && value->as_bool();
}

void expect_type(const json::object& schema, const mapping::ConfigValue& value) {
    const auto expect = [&](const char* type, const char* format) {
        EXPECT_EQ(schema.at("type"), type);
        ASSERT_EQ(schema.contains("format"), format != nullptr);
        if (format != nullptr) {
            EXPECT_EQ(schema.at("format"), format);
        }
    };
    if (std::holds_alternative<bool>(value)) expect("boolean", nullptr);
    if (std::holds_alternative<std::int32_t>(value)) expect("integer", "int32");
    if (std::holds_alternative<double>(value)) expect("number", "double");
    if (std::holds_alternative<std::string_view>(value)) expect("string", nullptr);
}

void expect_choices(const json::object& schema, const mapping::ConfigField& field) {
    std::vector<std::string> described;
    if (const auto* choices = schema.if_contains("enum")) {
        for (const auto& choice : choices->as_array()) described.emplace_back(choice.as_string());
    }
    const auto choices = mapping::choices_of(field);
    EXPECT_EQ(described, std::vector<std::string>(choices.begin(), choices.end()));
}

void expect_bound(const json::object& schema, const char* member, double bound) {
    ASSERT_EQ(schema.contains(member), std::isfinite(bound)) << member;
    if (std::isfinite(bound)) {
        EXPECT_DOUBLE_EQ(schema.at(member).to_number<double>(), bound) << member;
    }
}

/// Compares all members of a setting's schema but `description` and `default` with the table.
void expect_setting(const json::object& schema, const mapping::ConfigField& field) {
    expect_type(schema, mapping::value_of(field, {}));
    expect_choices(schema, field);
    expect_bound(schema, "minimum", field.bounds.low);
    expect_bound(schema, "maximum", field.bounds.high);
    EXPECT_EQ(is_true(schema, "exclusiveMinimum"), field.bounds.low_is_excluded);
    EXPECT_EQ(is_true(schema, "exclusiveMaximum"), field.bounds.high_is_excluded);
}

void expect_default(const json::object& schema, const mapping::ConfigField& field) {
    ASSERT_TRUE(schema.contains("default"));
    std::visit(
        [&]<class Value>(const Value& value) {
            if constexpr (std::is_same_v<Value, double>) {
                EXPECT_DOUBLE_EQ(schema.at("default").to_number<double>(), value);
            } else {
                EXPECT_EQ(schema.at("default"), json::value(value));
            }
        },
        mapping::value_of(field, {}));
}

std::set<std::string> setting_names() {
    std::set<std::string> names;
    for (const auto& field : mapping::config_fields()) names.emplace(field.name);
    return names;
}

TEST(OpenApiSettings, SchemasAgreeWithTheTable) {
    for (const char* schema : kSchemasWithSettings) {
        for (const auto& field : mapping::config_fields()) {
            SCOPED_TRACE(fmt::format("{}.{}", schema, field.name));
            const auto& properties = component("schemas", schema).at("properties").as_object();
            ASSERT_TRUE(properties.contains(field.name));
            const auto& described = properties.at(field.name).as_object();
            EXPECT_EQ(described.at("description").as_string(), description_with_unit(field));
            expect_setting(described, field);
        }
    }
}

TEST(OpenApiSettings, SchemasHaveNoOtherSettings) {
    for (const char* schema : kSchemasWithSettings) {
        std::set<std::string> names;
        for (const auto& property : component("schemas", schema).at("properties").as_object())
            names.emplace(property.key());
        for (const char* member : {"name", "until"}) names.erase(member);
        EXPECT_EQ(names, setting_names()) << schema;
    }
}

TEST(OpenApiSettings, OnlySessionRequestHasDefaults) {
    for (const auto& field : mapping::config_fields()) {
        SCOPED_TRACE(field.name);
        expect_default(component("schemas", "SessionRequest").at("properties").at(field.name).as_object(), field);
        EXPECT_FALSE(
            component("schemas", "SessionConfig").at("properties").at(field.name).as_object().contains("default"));
        EXPECT_FALSE(
            component("schemas", "WeaveRequest").at("properties").at(field.name).as_object().contains("default"));
    }
}

TEST(OpenApiSettings, SessionConfigRequiresAllSettings) {
    std::set<std::string> required;
    for (const auto& name : component("schemas", "SessionConfig").at("required").as_array())
        required.emplace(name.as_string());
    EXPECT_EQ(required, setting_names());
}

TEST(OpenApiSettings, QueryParametersAgreeWithTheTable) {
    for (const auto& field : mapping::config_fields()) {
        SCOPED_TRACE(field.name);
        const auto& parameter = component("parameters", field.name);
        EXPECT_EQ(parameter.at("name"), field.name);
        EXPECT_EQ(parameter.at("in"), "query");
        EXPECT_FALSE(is_true(parameter, "required"));
        EXPECT_EQ(parameter.at("description").as_string(),
                  description_with_unit(field) + " The maps are computed again from the log with it.");
        expect_setting(parameter.at("schema").as_object(), field);
        EXPECT_FALSE(parameter.at("schema").as_object().contains("default"));
    }
}

TEST(OpenApiSettings, OperationsHaveAllQueryParametersOrNone) {
    const auto all = setting_names();
    std::size_t with_settings = 0;
    for (const auto& path : described_api().at("paths").as_object()) {
        for (const auto& operation : path.value().as_object()) {
            std::set<std::string> settings;
            if (const auto* parameters = operation.value().as_object().if_contains("parameters")) {
                for (const auto& parameter : parameters->as_array()) {
                    const std::string name(resolved(parameter).at("name").as_string());
                    if (all.contains(name)) settings.insert(name);
                }
            }
            if (settings.empty()) continue;
            EXPECT_EQ(settings, all) << path.key() << " " << operation.key();
            ++with_settings;
        }
    }
    EXPECT_GT(with_settings, 0U);
}

} // namespace
} // namespace scanloom::http
