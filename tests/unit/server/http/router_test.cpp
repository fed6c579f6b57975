#include "server/http/router.hpp"

#include "server/http/target.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scanloom::http {
namespace {

Routing route(std::string_view method, std::string_view path) {
    return find_route(method, parse_target(path).value().segments);
}

/// A path that the pattern matches: the name of each variable stands for its value.
std::string example_of(std::string_view pattern) {
    std::string path(pattern);
    std::erase_if(path, [](char c) { return c == '{' || c == '}'; });
    return path;
}

TEST(Router, EveryRouteIsFoundByItsOwnPattern) {
    for (const auto& entry : routes()) {
        const auto routing = route(entry.method, example_of(entry.pattern));
        const auto* match = std::get_if<Match>(&routing);
        ASSERT_NE(match, nullptr) << entry.pattern;
        EXPECT_EQ(match->operation, entry.operation) << entry.pattern;
    }
}

TEST(Router, EveryOperationHasOneRoute) {
    std::set<Operation> seen;
    for (const auto& entry : routes()) EXPECT_TRUE(seen.insert(entry.operation).second) << entry.pattern;
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(Operation::kMakeBackup) + 1);
}

TEST(Router, UnknownPathsAreNotFoundWhateverTheMethod) {
    for (const auto* path : {"/api", "/api/v1/sessions/", "/api/v1/sessions/a/b", "/livez/", "//livez", "/LIVEZ", "/a",
                             "/assets/", "/assets/a/b"}) {
        EXPECT_TRUE(std::holds_alternative<NoSuchPath>(route("GET", path))) << path;
        EXPECT_TRUE(std::holds_alternative<NoSuchPath>(route("PUT", path))) << path;
    }
}

TEST(Router, OtherMethodsOfAKnownPathLearnWhichArePossible) {
    EXPECT_EQ(std::get<MethodNotAllowed>(route("PUT", "/api/v1/sessions")).allow, "GET, HEAD, POST");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("POST", "/api/v1/sessions/a")).allow, "GET, HEAD, DELETE");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("OPTIONS", "/livez")).allow, "GET, HEAD");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("get", "/livez")).allow, "GET, HEAD");
}

} // namespace
} // namespace scanloom::http
