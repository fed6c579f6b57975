#include "server/http/openapi.hpp"

#include "common/json/json_text.hpp"
#include "core/mapping/map_config.hpp"
#include "tests/unit/server/http/api_description.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

namespace json = boost::json;

const json::object& component(const char* kind, const char* name) {
    return openapi().at("components").at(kind).at(name).as_object();
}

/// Calls visit with each value below and at `value`.
template <class Visit>
void walk(const json::value& value, Visit&& visit) {
    visit(value);
    if (value.is_object()) {
        for (const auto& member : value.get_object()) walk(member.value(), visit);
    } else if (value.is_array()) {
        for (const auto& element : value.get_array()) walk(element, visit);
    }
}

TEST_F(ApiTest, ServesTheOpenApiDescription) {
    EXPECT_EQ(get("/openapi.json").body.bytes(), json_text(openapi()) + "\n");
}

TEST(OpenApi, AllReferencesResolve) {
    const auto& root = described_api();
    std::size_t count = 0;
    walk(root, [&](const json::value& value) {
        const auto* reference = value.is_object() ? value.get_object().if_contains("$ref") : nullptr;
        if (reference == nullptr) return;
        const std::string address(reference->as_string());
        json::error_code failed;
        EXPECT_NE(root.find_pointer(address.substr(1), failed), nullptr) << address;
        ++count;
    });
    EXPECT_GT(count, 50U);
}

TEST(OpenApi, OperationHasTheColumnsOfItsRoute) {
    const auto& get = openapi().at("paths").at("/api/v1/sessions/{session}/points.csv").at("get").as_object();
    EXPECT_EQ(get.at("operationId"), "pointsCsv");
    EXPECT_EQ(get.at("parameters"), json::parse(R"([{"$ref": "#/components/parameters/session"},
                                                    {"$ref": "#/components/parameters/since"},
                                                    {"$ref": "#/components/parameters/untilOfPoints"},
                                                    {"$ref": "#/components/parameters/robotOfPoints"},
                                                    {"$ref": "#/components/parameters/threshold"}])"));
    for (const char* status : {"200", "400", "401", "403", "404", "413", "500", "503"})
        EXPECT_TRUE(get.at("responses").as_object().contains(status)) << status;
    EXPECT_FALSE(get.contains("security"));
    EXPECT_EQ(openapi().at("paths").at("/livez").at("get").at("security"), json::array());
}

TEST(OpenApi, SettingsHaveTypeUnitBoundsAndDefault) {
    const auto& request = component("schemas", "SessionRequest").at("properties").as_object();
    EXPECT_EQ(request.at("p_free"), json::parse(R"({"type": "number", "format": "double", "minimum": 0.0,
        "maximum": 0.5, "exclusiveMinimum": true, "exclusiveMaximum": true, "default": 0.1,
        "description": "Probability of occupation before a hit."})"));
    EXPECT_EQ(request.at("danger_cells").at("format"), "int32");
    EXPECT_EQ(request.at("danger_cells").at("default"), 3);
    EXPECT_EQ(request.at("accumulate").at("type"), "boolean");
    EXPECT_EQ(request.at("accumulate").at("default"), false);
    EXPECT_EQ(request.at("ray_model").at("enum"), json::parse(R"(["inverse_sensor_model","bresenham","traversal"])"));
    EXPECT_EQ(request.at("ray_model").at("default"), "inverse_sensor_model");
    EXPECT_EQ(component("schemas", "SessionConfig").at("required").as_array().size(), mapping::config_fields().size());
    EXPECT_EQ(component("parameters", "cell_size"), json::parse(R"({"name": "cell_size", "in": "query",
        "required": false, "schema": {"type": "number", "format": "double", "minimum": 0.01, "maximum": 1.0},
        "description": "Side of a cell (m). The maps are computed again from the log with it."})"));
    for (const auto* schema : {"SessionConfig", "WeaveRequest"})
        EXPECT_FALSE(component("schemas", schema).at("properties").at("p_free").as_object().contains("default"));
}

} // namespace
} // namespace scanloom::http
