#include "core/mapping/map_config.hpp"
#include "server/http/openapi.hpp"
#include "server/http/routes.hpp"

#include <boost/algorithm/string/case_conv.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

/// docs/http.md has a table of all operations.
namespace scanloom::http {
namespace {

constexpr std::string_view kBegin = "<!-- Made from routes.cpp and openapi.yaml -->\n";
constexpr std::string_view kEnd = "<!-- End of the table -->\n";

std::string shown_path(std::string_view path) {
    constexpr std::string_view kSession = "/api/v1/sessions/{session}/";
    if (!path.starts_with(kSession)) return std::string(path);
    return fmt::format(".../{}", path.substr(kSession.size()));
}

std::string shown_parameters(const Route& route) {
    if (takes_any_parameter(route)) return "";
    std::vector<std::string> shown;
    bool has_settings = false;
    for (const auto name : route.parameters) {
        if (mapping::find_config_field(name) == nullptr)
            shown.push_back(fmt::format("`{}`", name));
        else
            has_settings = true;
    }
    if (has_settings) shown.emplace_back("[settings](settings.md)");
    return fmt::format("{}", fmt::join(shown, ", "));
}

std::string table_of_operations() {
    std::string table = "| request | parameters | what it does or returns |\n|---|---|---|\n";
    for (const auto& route : routes()) {
        const std::string method(name_of(route.method));
        const auto& described = openapi().at("paths").at(route.path).at(boost::algorithm::to_lower_copy(method));
        fmt::format_to(std::back_inserter(table), "| `{} {}` | {} | {} |\n", method, shown_path(route.path),
                       shown_parameters(route), std::string_view(described.at("summary").as_string()));
    }
    return table;
}

TEST(OperationsTable, InTheDocumentationIsThatOfTheRoutes) {
    std::ifstream file(SCANLOOM_SOURCE_DIR "/docs/http.md");
    const std::string page(std::istreambuf_iterator<char>(file), {});
    const auto begin = page.find(kBegin) + kBegin.size();
    const auto end = page.find(kEnd);
    ASSERT_TRUE(begin != std::string::npos && end != std::string::npos) << "docs/http.md has no place for the table";
    const auto right = page.substr(0, begin) + table_of_operations() + page.substr(end);
    if (right == page) return;
    std::ofstream(SCANLOOM_BUILD_DIR "/http.md") << right;
    FAIL() << "docs/http.md is out of date; run: cp " SCANLOOM_BUILD_DIR "/http.md " SCANLOOM_SOURCE_DIR
              "/docs/http.md";
}

} // namespace
} // namespace scanloom::http
