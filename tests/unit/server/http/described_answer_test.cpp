#include "tests/unit/server/http/described_answer.hpp"

#include "server/http/problem.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Request kDigest{.target = "/api/v1/sessions/a/digest"};

std::vector<std::string> of_digest(std::string_view body) { return undescribed(kDigest, ok(boost::json::parse(body))); }

TEST(DescribedAnswer, FindsEveryFault) {
    EXPECT_THAT(of_digest(R"({"layers":{}})"), ElementsAre(HasSubstr("body.revision is missing")));
    EXPECT_THAT(of_digest(R"({"revision":1,"layers":{},"x":1})"), ElementsAre(HasSubstr("body.x is not described")));
    EXPECT_THAT(of_digest(R"({"revision":"1","layers":{}})"), ElementsAre(HasSubstr("body.revision is no integer")));
    EXPECT_THAT(undescribed(kDigest, ok("text/plain", Body("x"))),
                ElementsAre(HasSubstr("text/plain is not described")));
    EXPECT_THAT(undescribed(kDigest, problem(Error{Errc::kTooLarge, "no"}, "/")),
                ElementsAre(HasSubstr("status 413 is not described")));
    const auto list = [](std::string_view session) {
        const auto body = boost::json::parse(fmt::format(R"({{"sessions":[{}],"next":null}})", session));
        return undescribed({.target = "/api/v1/sessions"}, ok(body));
    };
    EXPECT_THAT(list(R"({"name":"a","state":"damaged","reason":"r"})"), IsEmpty());
    EXPECT_THAT(list(R"({"name":"a","state":"odd","reason":"r"})"),
                testing::Contains(HasSubstr("body.sessions[].state has a value that is not described")));
}

} // namespace
} // namespace scanloom::http
