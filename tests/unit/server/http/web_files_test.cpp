#include "server/http/web_files.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::http {
namespace {

using testing::HasSubstr;

class WebFilesTest : public testing::Test {
protected:
    void write(const std::string& name, const std::string& content) {
        const auto path = folder_.path() / name;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << content;
    }

    [[nodiscard]] WebFiles load() const { return load_web_files(folder_.path()).value(); }

    TemporaryDirectory folder_;
};

TEST_F(WebFilesTest, PageHasTheContentSecurityPolicy) {
    write("index.html", "<p>hello");
    const auto response = serve_web_file(load(), "index.html", "", "").value();
    EXPECT_EQ(response.status, Status::ok);
    EXPECT_EQ(response.body.bytes(), "<p>hello");
    EXPECT_EQ(response.get("Content-Type"), "text/html; charset=utf-8");
    EXPECT_EQ(response.get("Cache-Control"), "no-cache");
    EXPECT_THAT(std::string(response.get("Content-Security-Policy")),
                AllOf(HasSubstr("default-src 'self';"), HasSubstr("img-src 'self' data: blob:;"),
                      HasSubstr("frame-ancestors 'none'")));
}

TEST_F(WebFilesTest, PolicyAllowsOnlyWebSocketsOfThisServer) {
    write("index.html", "");
    const auto policy_for = [&](std::string_view host) {
        return std::string(serve_web_file(load(), "index.html", "", host).value().get("Content-Security-Policy"));
    };
    EXPECT_THAT(policy_for("localhost:8080"),
                HasSubstr("connect-src 'self' ws://localhost:8080 wss://localhost:8080;"));
    const auto over_tls = serve_web_file(load(), "index.html", "", "localhost:8080", true).value();
    EXPECT_THAT(std::string(over_tls.get("Content-Security-Policy")),
                HasSubstr("connect-src 'self' wss://localhost:8080;"));
    for (const auto* hostile : {"", "a;script-src *", "a b", "[::1]:80", "*", "a/b"}) {
        EXPECT_THAT(policy_for(hostile), HasSubstr("connect-src 'self';")) << hostile;
    }
}

TEST_F(WebFilesTest, HashedAssetsAreImmutable) {
    write("index.html", "");
    write("assets/index-BvC3kD9x.js", "1");
    write("assets/icon.svg", "<svg/>");
    const auto files = load();
    const auto script = serve_web_file(files, "assets/index-BvC3kD9x.js", "", "").value();
    EXPECT_EQ(script.get("Content-Type"), "text/javascript; charset=utf-8");
    EXPECT_THAT(std::string(script.get("Cache-Control")), HasSubstr("immutable"));
    const auto icon = serve_web_file(files, "assets/icon.svg", "", "").value();
    EXPECT_EQ(icon.get("Content-Type"), "image/svg+xml");
    EXPECT_EQ(icon.get("Cache-Control"), "no-cache");
}

TEST_F(WebFilesTest, EntityTagFollowsTheContent) {
    write("index.html", "one");
    const std::string etag(serve_web_file(load(), "index.html", "", "").value().get("ETag"));
    EXPECT_EQ(serve_web_file(load(), "index.html", etag, "").value().status, Status::not_modified);
    write("index.html", "two");
    EXPECT_EQ(serve_web_file(load(), "index.html", etag, "").value().status, Status::ok);
}

TEST_F(WebFilesTest, NotModifiedKeepsPolicyAndCaching) {
    write("index.html", "<p>hello");
    write("assets/index-BvC3kD9x.js", "1");
    const auto files = load();
    const auto policies = [](const Response& response) {
        const auto head = head_text(response, Persistence::kKeepAlive, "");
        const auto begin = head.find("Content-Security-Policy:");
        EXPECT_EQ(head.find("Content-Security-Policy:", begin + 1), std::string::npos);
        return head.substr(begin, head.find("\r\n", begin) - begin);
    };
    for (const auto* name : {"index.html", "assets/index-BvC3kD9x.js"}) {
        const auto whole = serve_web_file(files, name, "", "").value();
        const auto again = serve_web_file(files, name, whole.get("ETag"), "").value();
        EXPECT_EQ(again.status, Status::not_modified);
        EXPECT_EQ(policies(again), policies(whole)) << name;
        EXPECT_THAT(policies(again), HasSubstr("default-src 'self'"));
        EXPECT_EQ(again.get("Cache-Control"), whole.get("Cache-Control"));
    }
}

TEST_F(WebFilesTest, OnlyFilesReadAtTheStartAreServed) {
    write("index.html", "");
    write("secret.txt", "secret");
    write("assets/deeper/a.js", "1");
    const auto files = load();
    for (const auto* name : {"secret.txt", "assets/deeper/a.js", "assets/../secret.txt", "/etc/passwd", "", "assets"}) {
        const auto response = serve_web_file(files, name, "", "");
        ASSERT_FALSE(response) << name;
        EXPECT_EQ(response.error().code, Errc::kNotFound) << name;
    }
}

TEST_F(WebFilesTest, MissingViewerPageSaysHowToBuildIt) {
    const auto files = load_web_files(folder_.path() / "missing").value();
    EXPECT_TRUE(files.empty());
    const auto response = serve_web_file(files, "index.html", "", "").value();
    EXPECT_EQ(response.status, Status::not_found);
    EXPECT_THAT(std::string(response.body.bytes()), HasSubstr("./scanloom build"));
}

} // namespace
} // namespace scanloom::http
