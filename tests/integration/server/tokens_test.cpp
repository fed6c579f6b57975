#include "common/wire/messages.hpp"
#include "tests/support/http_client.hpp"
#include "tests/support/robot_socket.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <sys/stat.h>

namespace scanloom::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::HttpClient;
using testing_support::RobotSocket;

/// The output of `scanloom-server token`.
struct MadeToken {
    std::string secret;
    std::string lines; ///< lines for the token file
};

/// A server with tokens that were created by its command.
class TokensTest : public testing::Test {
protected:
    TokensTest() {
        write(robot_.lines + viewer_.lines + operator_.lines);
        server_ = std::make_unique<RunningServer>(
            place_.path() / "store", log_, 0, 0,
            std::vector<std::string>{"--tokens", file_.string(), "--log-level", "debug"});
    }

    struct Tokens {
        MadeToken robot = make("robot", "robot", "depot-*");
        MadeToken viewer = make("viewer", "viewer", "depot-*");
        MadeToken chief = make("chief", "operator", "*");
    };

    /// Makes them once for all tests.
    static const Tokens& tokens() {
        static const Tokens made;
        return made;
    }

    static MadeToken make(const std::string& name, const std::string& role, const std::string& sessions) {
        const TemporaryDirectory place;
        ChildProcess maker(program("scanloom-server"), {"token", "--name", name, "--role", role, "--session", sessions},
                           place.path() / "maker");
        MadeToken made;
        made.secret = maker.read_line().value();
        while (const auto line = maker.read_line()) made.lines += *line + "\n";
        EXPECT_EQ(maker.wait(), 0);
        return made;
    }

    void write(const std::string& content) const {
        std::ofstream(file_) << content;
        std::filesystem::permissions(file_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    }

    [[nodiscard]] std::string log() const {
        std::ifstream file(log_);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    void wait_for_log(const std::string& text) const {
        while (log().find(text) == std::string::npos) std::this_thread::yield();
    }

    [[nodiscard]] int status(const std::string& method, const std::string& target, const std::string& fields,
                             const std::string& body = "") const {
        HttpClient client(server_->http_port());
        client.send(fmt::format("{} {} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                                "Content-Length: {}\r\n{}\r\n{}",
                                method, target, body.size(), fields, body));
        return client.read(method != "HEAD").status;
    }

    [[nodiscard]] static std::string bearer(const MadeToken& token) {
        return "Authorization: Bearer " + token.secret + "\r\n";
    }

    [[nodiscard]] static wire::Hello hello(const std::string& secret, const std::string& session) {
        wire::Hello said;
        said.robot = "r1";
        said.session = session;
        said.token = secret;
        said.create = SessionOptions{};
        return said;
    }

    [[nodiscard]] std::string refusal(const wire::Hello& hello) const {
        RobotSocket robot(server_->robot_port());
        robot.send(hello);
        const auto answer = robot.receive();
        const auto* error = answer ? std::get_if<wire::LinkError>(&*answer) : nullptr;
        return error == nullptr ? "welcome" : error->error.message;
    }

    TemporaryDirectory place_;
    std::filesystem::path file_ = place_.path() / "tokens.toml";
    std::filesystem::path log_ = place_.path() / "log";
    const MadeToken& robot_ = tokens().robot;
    const MadeToken& viewer_ = tokens().viewer;
    const MadeToken& operator_ = tokens().chief;
    std::unique_ptr<RunningServer> server_;
};

TEST_F(TokensTest, BothPortsRequireTheTokensOfTheFile) {
    EXPECT_EQ(refusal(hello(robot_.secret, "depot-1")), "welcome");
    EXPECT_THAT(refusal(hello("", "depot-1")), HasSubstr("a token is needed"));
    EXPECT_THAT(refusal(hello(robot_.secret, "lab")), HasSubstr("not for the session"));
    EXPECT_EQ(status("GET", "/api/v1/sessions/depot-1", ""), 401);
    EXPECT_EQ(status("GET", "/api/v1/sessions/depot-1", bearer(viewer_)), 200);
}

/// Reading a refused body would cost memory and time.
TEST_F(TokensTest, UnauthorizedRequestsAreRefusedBeforeTheirBody) {
    HttpClient client(server_->http_port());
    client.send("POST /api/v1/sessions/depot-1/import HTTP/1.1\r\nHost: localhost\r\n"
                "Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 50000000\r\n\r\n");
    EXPECT_EQ(client.read().status, 401);
}

TEST_F(TokensTest, TheFileIsReloadedOnSighupUnlessItIsInvalid) {
    RobotSocket robot(server_->robot_port());
    robot.send(hello(robot_.secret, "depot-1"));
    static_cast<void>(robot.receive_kind<wire::Welcome>());

    write("[[token]]\nname = 3\n");
    server_->process().signal(SIGHUP);
    wait_for_log("the previous tokens stay in force");
    EXPECT_THAT(log(), HasSubstr(file_.string() + ":2: name is not a text"));
    EXPECT_EQ(status("GET", "/api/v1/sessions/depot-1", bearer(viewer_)), 200);
    robot.send(wire::Ping{7});
    EXPECT_EQ(robot.receive_kind<wire::Pong>().nonce, 7U);

    const auto later = make("later", "viewer", "*");
    write(operator_.lines + later.lines);
    server_->process().signal(SIGHUP);
    const auto end = robot.receive();
    ASSERT_TRUE(end && std::holds_alternative<wire::LinkError>(*end));
    EXPECT_EQ(std::get<wire::LinkError>(*end).error.code, Errc::kUnauthorized);
    EXPECT_FALSE(std::get<wire::LinkError>(*end).retryable);
    EXPECT_EQ(status("GET", "/api/v1/sessions/depot-1", bearer(viewer_)), 401);
    EXPECT_EQ(status("GET", "/api/v1/sessions/depot-1", bearer(later)), 200);
}

/// A program that rotates the token file does not know the server's progress at startup.
TEST_F(TokensTest, SighupDuringStartupDoesNotEndTheServer) {
    const auto settings = place_.path() / "settings";
    ASSERT_EQ(::mkfifo(settings.c_str(), 0600), 0);
    ChildProcess server(program("scanloom-server"),
                        {"--store", place_.path() / "another", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0",
                         "--config", settings},
                        place_.path() / "another.log");
    std::ofstream file(settings); // blocks until the server has started to read
    server.signal(SIGHUP);
    file << "threads = 1\n";
    file.close();
    EXPECT_THAT(server.read_line().value_or("nothing"), HasSubstr("ready"));
    server.signal(SIGTERM);
    EXPECT_EQ(server.wait(), 0);
}

TEST_F(TokensTest, SecretsNeverAppearInTheLog) {
    const auto& secret = viewer_.secret;
    EXPECT_EQ(status("GET", "/api/v1/sessions/" + secret, ""), 401);
    EXPECT_EQ(status("GET", "/api/v1/sessions/" + secret, bearer(viewer_)), 403);
    EXPECT_EQ(status("GET", "/api/v1/sessions?token=" + secret, bearer(viewer_)), 400);
    EXPECT_EQ(status(secret, "/", ""), 405);
    EXPECT_EQ(status("GET", "/livez", "Host: " + secret + "\r\n"), 400);
    EXPECT_EQ(status("GET", "/" + secret, ""), 404);
    EXPECT_EQ(status("POST", "/api/v1/sessions", bearer(operator_), R"({"name":")" + secret + R"("})"), 400);
    EXPECT_EQ(status("GET", "/api/v1/sessions", "Authorization: Basic " + secret + "\r\n"), 401);
    EXPECT_EQ(status("GET", "/api/v1/sessions", "Cookie: scanloom_login=" + secret + "\r\n"), 401);
    EXPECT_EQ(status("POST", "/api/v1/sessions", "Origin: http://" + secret + "\r\n", "{}"), 401);
    EXPECT_EQ(status("POST", "/api/v1/login", "", R"({"token":")" + secret + R"("})"), 200);
    for (const auto field : {&wire::Hello::robot, &wire::Hello::session, &wire::Hello::client, &wire::Hello::source}) {
        auto said = hello(robot_.secret, "depot-1");
        said.*field = secret;
        static_cast<void>(refusal(said));
        said.*field = secret.substr(0, 64); // the maximum length of a name
        static_cast<void>(refusal(said));
    }
    RobotSocket robot(server_->robot_port());
    robot.send_bytes(secret);
    while (robot.receive()) {
    }
    server_->process().signal(SIGTERM);
    EXPECT_EQ(server_->process().wait(), 0);
    const auto said = log();
    for (const auto& token : {robot_, viewer_, operator_}) {
        for (std::size_t at = 9; at + 12 <= token.secret.size(); ++at) // any part that reveals the secret
            EXPECT_THAT(said, Not(HasSubstr(token.secret.substr(at, 12))));
    }
    EXPECT_THAT(said, HasSubstr("event=refused port=http who=127.0.0.1 token=viewer reason=wrong_session session=? "));
}

TEST_F(TokensTest, AFileWritableByOthersPreventsTheStart) {
    std::filesystem::permissions(file_, std::filesystem::perms::others_write, std::filesystem::perm_options::add);
    ChildProcess other(program("scanloom-server"),
                       {"--store", (place_.path() / "other").string(), "--listen", "127.0.0.1:0", "--http",
                        "127.0.0.1:0", "--tokens", file_.string()},
                       place_.path() / "other-log");
    EXPECT_EQ(other.wait(), 1);
    std::ifstream said(place_.path() / "other-log");
    EXPECT_THAT(std::string(std::istreambuf_iterator<char>(said), {}), HasSubstr("chmod go-w"));
}

} // namespace
} // namespace scanloom::test
