#include "server/http/problem.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

using testing::HasSubstr;
using testing::Not;

boost::json::object body_of(const Response& response) { return boost::json::parse(response.body.bytes()).as_object(); }

TEST(Problem, HasTheMembersOfRfc9457) {
    const auto response = problem(Error{Errc::kNotFound, "there is no \"x\""}, "/api/v1/sessions/x");
    EXPECT_EQ(response.status, Status::not_found);
    EXPECT_EQ(response.get("Content-Type"), "application/problem+json");
    EXPECT_EQ(body_of(response), (boost::json::object{{"type", "urn:scanloom:error:not_found"},
                                                      {"title", "Not found"},
                                                      {"status", 404},
                                                      {"detail", "there is no \"x\""},
                                                      {"instance", "/api/v1/sessions/x"}}));
}

TEST(Problem, EachErrorHasItsStatus) {
    EXPECT_EQ(status_of(Errc::kMalformed), Status::bad_request);
    EXPECT_EQ(status_of(Errc::kInvalidField), Status::bad_request);
    EXPECT_EQ(status_of(Errc::kUnauthorized), Status::unauthorized);
    EXPECT_EQ(status_of(Errc::kNotFound), Status::not_found);
    EXPECT_EQ(status_of(Errc::kAlreadyExists), Status::conflict);
    EXPECT_EQ(status_of(Errc::kGone), Status::gone);
    EXPECT_EQ(status_of(Errc::kTooLarge), Status::payload_too_large);
    EXPECT_EQ(status_of(Errc::kStoreFailed), Status::service_unavailable);
    EXPECT_EQ(status_of(Errc::kDataLoss), Status::internal_server_error); // no Retry-After
    EXPECT_EQ(status_of(Errc::kShuttingDown), Status::service_unavailable);
    EXPECT_EQ(status_of(Errc::kOverloaded), Status::service_unavailable);
    EXPECT_EQ(status_of(Errc::kFull), Status::insufficient_storage);
    EXPECT_EQ(status_of(Errc::kNoPath), Status::conflict);
    EXPECT_EQ(status_of(Errc::kInternal), Status::internal_server_error);
}

TEST(Problem, NoErrorHasTheDefaultStatus) {
    for (int code = 0; name_of(static_cast<Errc>(code)) != "unknown"; ++code) {
        if (static_cast<Errc>(code) == Errc::kInternal || static_cast<Errc>(code) == Errc::kDataLoss) continue;
        EXPECT_NE(status_of(static_cast<Errc>(code)), Status::internal_server_error) << code;
    }
}

TEST(Problem, ExtensionsAreMembers) {
    const auto response = problem(Status::service_unavailable, "not ready", "/readyz", {{"reasons", {"a", "b"}}});
    const auto body = body_of(response);
    EXPECT_EQ(body.at("title"), "Service Unavailable");
    EXPECT_EQ(body.at("type"), "about:blank");
    EXPECT_EQ(body.at("reasons"), (boost::json::array{"a", "b"}));
}

TEST(Problem, InstanceIsAShortPrintablePath) {
    EXPECT_EQ(instance_of("/a/b?secret=1"), "/a/b");
    EXPECT_EQ(instance_of("/a\x1B\xFF"
                          "b"),
              "/a??b");
    EXPECT_EQ(instance_of("/" + std::string(9'000, 'a')).size(), 256U);
}

TEST(ResponseHead, HasTheCommonFields) {
    const auto head = head_text(ok("text/plain", Body("12345")), Persistence::kKeepAlive, "DATE");
    EXPECT_EQ(head, "HTTP/1.1 200 OK\r\nDate: DATE\r\nContent-Type: text/plain\r\nContent-Length: 5\r\n"
                    "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
                    "Content-Security-Policy: default-src 'none'; frame-ancestors 'none'\r\n\r\n");
    EXPECT_THAT(head_text(ok("text/plain", Body("")), Persistence::kClose, ""), HasSubstr("Connection: close\r\n"));
}

TEST(ResponseHead, AllowsNoForeignOrigin) {
    EXPECT_THAT(head_text(ok(boost::json::value(1)), Persistence::kKeepAlive, ""), Not(HasSubstr("Access-Control")));
}

TEST(ResponseHead, ResponseWithoutBodyHasNoLength) {
    EXPECT_THAT(head_text(not_modified("\"1\"", kRevalidate), Persistence::kKeepAlive, ""),
                Not(HasSubstr("Content-Length")));
    const Response gone{.status = Status::no_content, .fields = {}, .body = {}};
    EXPECT_THAT(head_text(gone, Persistence::kKeepAlive, ""), Not(HasSubstr("Content-Length")));
}

} // namespace
} // namespace scanloom::http
