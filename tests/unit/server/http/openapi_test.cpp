#include "server/http/routes.hpp"
#include "tests/unit/server/http/api_description.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <boost/url/grammar/ci_string.hpp>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

namespace scanloom::http {
namespace {

/// Calls visit with each value below and at `value`.
template <class Visit>
void walk(const boost::json::value& value, Visit&& visit) {
    visit(value);
    if (value.is_object()) {
        for (const auto& member : value.get_object()) walk(member.value(), visit);
    } else if (value.is_array()) {
        for (const auto& element : value.get_array()) walk(element, visit);
    }
}

TEST_F(ApiTest, ServesTheOpenApiFile) {
    std::ifstream file(OPENAPI_FILE);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(get("/openapi.json").body.bytes(), text);
}

TEST(OpenApi, DescribesExactlyTheRoutes) {
    std::set<std::string> routed;
    for (const auto& route : routes())
        routed.insert(std::string(name_of(route.method)) + " " + std::string(route.path));
    std::set<std::string> described;
    const auto& whole = described_api();
    for (const auto& path : whole.at("paths").as_object()) {
        for (const auto& method : path.value().as_object()) {
            const bool is_get = boost::urls::grammar::ci_is_equal(method.key(), "get");
            const std::string name = is_get ? "GET" : method.key() == "post" ? "POST" : "DELETE";
            described.insert(name + " " + std::string(path.key()));
        }
    }
    EXPECT_EQ(described, routed);
}

TEST(OpenApi, AllReferencesResolve) {
    const auto& root = described_api();
    std::size_t count = 0;
    walk(root, [&](const boost::json::value& value) {
        const auto* reference = value.is_object() ? value.get_object().if_contains("$ref") : nullptr;
        if (reference == nullptr) return;
        const std::string address(reference->as_string());
        boost::json::error_code failed;
        EXPECT_NE(root.find_pointer(address.substr(1), failed), nullptr) << address;
        ++count;
    });
    EXPECT_GT(count, 50U);
}

TEST(OpenApi, PathVariablesAreParameters) {
    const auto& root = described_api();
    for (const auto& path : root.at("paths").as_object()) {
        for (const auto& operation : path.value().as_object()) {
            std::set<std::string> described;
            if (const auto* parameters = operation.value().as_object().if_contains("parameters")) {
                for (const auto& parameter : parameters->as_array()) {
                    boost::json::error_code failed;
                    const std::string address(parameter.at("$ref").as_string());
                    const auto* target = root.find_pointer(address.substr(1), failed);
                    ASSERT_NE(target, nullptr) << address;
                    if (target->at("in") == "path") described.insert(std::string(target->at("name").as_string()));
                }
            }
            std::set<std::string> named;
            const std::string pattern(path.key());
            for (auto open = pattern.find('{'); open != std::string::npos; open = pattern.find('{', open + 1)) {
                named.insert(pattern.substr(open + 1, pattern.find('}', open) - open - 1));
            }
            EXPECT_EQ(described, named) << pattern;
        }
    }
}

} // namespace
} // namespace scanloom::http
