#include "tests/support/http_client.hpp"
#include "tests/support/live_client.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"
#include "tests/support/tls_http_client.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Several servers that share a database, as users run them.
namespace scanloom::test {
namespace {

class NodesTrials : public testing::Test {
protected:
    [[nodiscard]] std::unique_ptr<RunningServer> start(const std::string& node,
                                                       const std::vector<std::string>& more = {}) const {
        std::vector<std::string> options{"--allow-unreplicated", "--node", node, "--log-level", "warn"};
        options.insert(options.end(), more.begin(), more.end());
        return std::make_unique<RunningServer>(database_, place_.path() / node, 0, 0, options);
    }

    /// @param scans  of the whole simulation; those that the servers have already are not sent again
    void simulate(const std::string& servers, const std::string& scans) const {
        expect_done(start_robot(servers, scans, "0"));
    }

    /// @param speed  relative to real time; 0: as fast as the server accepts scans
    [[nodiscard]] std::unique_ptr<ChildProcess> start_robot(const std::string& servers, const std::string& scans,
                                                            const std::string& speed) const {
        return std::unique_ptr<ChildProcess>(
            new ChildProcess(program("scanloom-robot"),
                             {"--server", servers, "--session", "one", "--robot", "r", "--give-up-after", "20",
                              "simulate", "--world", "office", "--seed", "5", "--speed", speed, "--scans", scans},
                             place_.path() / "robot"));
    }

    static void expect_done(std::unique_ptr<ChildProcess> robot) {
        static_cast<void>(robot->read_line());
        ASSERT_EQ(robot->wait(), 0);
    }

    static void end(RunningServer& server, int signal) {
        server.process().signal(signal);
        static_cast<void>(server.process().wait());
    }

    static bool answers(std::uint16_t port) {
        try {
            return http_request(port, "GET", "/livez").status == 200;
        } catch (const std::exception&) { // it does not listen yet
            return false;
        }
    }

    static std::string digest(const RunningServer& server) {
        return boost::json::serialize(server.get_json("/api/v1/sessions/one/digest").at("layers"));
    }

    /// All tests of a suite share it, because it takes a second to start.
    static PostgresServer& postgres() {
        static PostgresServer started;
        return started;
    }

    TemporaryDirectory place_;
    const std::string database_ = postgres().new_database();
};

class NodesTest : public NodesTrials {};

TEST_F(NodesTest, ASessionGoesOnAnotherServerWhenItsOwnHasEnded) {
    auto a = start("a");
    const auto b = start("b");
    simulate(a->robot_address(), "300");
    const auto before = digest(*a);
    EXPECT_EQ(digest(*b), before) << "passed on to a";
    EXPECT_EQ(a->get_json("/readyz").at("warnings").as_array().size(), 1U) << "the database has no standby";
    auto node = [&] { return b->get_json("/api/v1/nodes").at("nodes").at(0); };
    EXPECT_EQ(node().at("name"), "a");
    while (node().at("sessions") != 1) { // it knows it a second later
    }
    EXPECT_EQ(b->get_json("/api/v1/sessions").at("sessions").at(0).at("node"), "a");
    EXPECT_EQ(http_request(a->http_port(), "POST", "/api/v1/node/drain", "{}").status, 202U);
    ASSERT_TRUE(a->process().has_output_within(std::chrono::seconds(30))) << "a has not ended";
    EXPECT_EQ(a->process().wait(), 0);
    EXPECT_EQ(digest(*b), before);

    end(*b, SIGKILL);
    const auto again = start("b"); // at once, because it has the name of the dead one
    EXPECT_EQ(digest(*again), before);
}

TEST_F(NodesTest, RequestsAreAnsweredAsByTheServerThatHasTheSession) {
    const auto a = start("a");
    const auto b = start("b");
    simulate(a->robot_address(), "300");
    const std::string session = "/api/v1/sessions/one";
    for (const char* target : {"", "/map.png", "/map.pgm", "/tiles/map.json", "/log", "/trajectory.tum",
                               "/changes?since=5", "/map.png?layer=nonsense", "/goal?robot=absent", "/exclusions"}) {
        const auto from_a = a->get(session + target);
        const auto from_b = b->get(session + target);
        EXPECT_EQ(from_b.status, from_a.status) << target;
        EXPECT_EQ(from_b.etag, from_a.etag) << target;
        EXPECT_EQ(from_b.body, from_a.body) << target;
    }
    const std::string goal = R"({"from": {"x": 0, "y": 0}, "to": {"x": 1, "y": 1}})";
    EXPECT_EQ(http_request(b->http_port(), "POST", session + "/plan", goal).body,
              http_request(a->http_port(), "POST", session + "/plan", goal).body);
    EXPECT_EQ(
        http_request(b->http_port(), "POST", session + "/exclude", R"({"robot": "r", "from": 0, "to": 0.5})").status,
        201U);
    EXPECT_NE(a->get_json(session).at("exclusions"), 0) << "a has excluded the scans";

    testing_support::HttpClient kept(b->http_port());
    for (const char* method : {"GET", "HEAD", "GET"}) {
        kept.send(std::string(method) + " " + session + "/map.png HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        EXPECT_EQ(kept.read(std::string_view(method) == "GET").status, 200) << "on one connection";
    }
    kept.send("HEAD " + session + "/log HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"); // without the body's chunks
    EXPECT_EQ(kept.read(false).status, 200);
    kept.send("GET " + session + "/map.yaml HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    EXPECT_EQ(kept.read().status, 200);
    testing_support::LiveClient at_a(a->http_port(), "one");
    testing_support::LiveClient at_b(b->http_port(), "one");
    EXPECT_EQ(at_b.read(), at_a.read());
    for (const auto* server : {a.get(), b.get()}) {
        testing_support::HttpClient foxglove(server->http_port());
        foxglove.send("GET " + session +
                      "/foxglove HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                      "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n");
        const auto answer = foxglove.read();
        EXPECT_EQ(answer.status, 101);
        EXPECT_EQ(answer.fields.at("sec-websocket-protocol"), "foxglove.sdk.v1");
    }
    EXPECT_EQ(http_request(b->http_port(), "DELETE", session).status, 204U);
    EXPECT_EQ(a->get(session).status, 404U);
}

TEST_F(NodesTest, ASignInHoldsAtAllServersAlsoWithTls) {
    const auto files = testing_support::write_certificate(place_.path(), "127.0.0.1");
    const auto tokens = place_.path() / "tokens.toml";
    ChildProcess maker(program("scanloom-server"), {"token", "--name", "o", "--role", "operator"},
                       place_.path() / "maker");
    const auto secret = maker.read_line().value();
    std::string lines;
    while (const auto line = maker.read_line()) lines += *line + "\n";
    std::ofstream(tokens) << lines;
    const std::vector<std::string> options{"--tokens",        tokens,           "--http-tls-cert",
                                           files.certificate, "--http-tls-key", files.key};
    ::setenv("SSL_CERT_FILE", files.certificate.c_str(), 1); // with which servers verify each other
    const auto a = start("a", options);
    const auto b = start("b", options);
    ::unsetenv("SSL_CERT_FILE");
    const auto ask = [&](const auto& server, const std::string& line, const std::string& field,
                         const std::string& body = {}) {
        testing_support::TlsHttpClient client(server->http_port(), {.trusted = files.certificate});
        client.send(fmt::format("{} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n{}\r\n"
                                "Content-Length: {}\r\n\r\n{}",
                                line, field, body.size(), body));
        return client.read();
    };
    const auto bearer = "Authorization: Bearer " + secret;
    ASSERT_EQ(ask(a, "POST /api/v1/sessions", bearer, R"({"name": "one"})").status, 201);
    const auto login = ask(a, "POST /api/v1/login", "DNT: 1", fmt::format(R"({{"token": "{}"}})", secret));
    ASSERT_EQ(login.status, 200) << login.body;
    const auto set = login.fields.at("set-cookie");
    const auto cookie = "Cookie: " + set.substr(0, set.find(';'));
    const auto from_a = ask(a, "GET /api/v1/sessions/one", cookie);
    EXPECT_EQ(from_a.status, 200);
    const auto from_b = ask(b, "GET /api/v1/sessions/one", cookie);
    EXPECT_EQ(from_b.body, from_a.body) << "passed on to a";
    EXPECT_EQ(ask(b, "GET /api/v1/sessions/one", "DNT: 1").status, 401);
}

/// The configuration in the documents, with other addresses.
TEST_F(NodesTrials, ALoadBalancerShowsAllServersAsOne) {
    auto a = start("a");
    const auto b = start("b");
    const auto c = start("c");
    simulate(a->robot_address(), "300");
    std::ifstream file(std::filesystem::path(SCANLOOM_SOURCE_DIR) / "docs/cluster/haproxy.cfg");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto replace = [&](const std::string& from, const std::string& to) {
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), from.size(), to);
    };
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket reserved(io, boost::asio::ip::tcp::v4()); // keeps the port for the balancer
    reserved.set_option(boost::asio::socket_base::reuse_address(true));
    reserved.bind({boost::asio::ip::address_v4::loopback(), 0});
    const auto port = reserved.local_endpoint().port();
    replace("bind :8080", "bind 127.0.0.1:" + std::to_string(port));
    for (const auto& [name, server] : {std::pair("node1", a.get()), {"node2", b.get()}, {"node3", c.get()}}) {
        replace(std::string(name) + ":8080", "127.0.0.1:" + std::to_string(server->http_port()));
    }
    std::ofstream(place_.path() / "haproxy.cfg") << text;
    ChildProcess balancer("/usr/sbin/haproxy", {"-db", "-f", place_.path() / "haproxy.cfg"}, place_.path() / "haproxy");
    while (!answers(port)) {
        ASSERT_FALSE(balancer.has_output_within(std::chrono::milliseconds(5))) << "it has ended";
    }
    const auto digest_through_it = [&] { return http_request(port, "GET", "/api/v1/sessions/one/digest").body; };
    const auto expected = a->get("/api/v1/sessions/one/digest").body;
    for (int n = 0; n < 6; ++n) EXPECT_EQ(digest_through_it(), expected);
    testing_support::LiveClient viewer(port, "one");
    EXPECT_TRUE(viewer.read());
    end(*a, SIGTERM);
    for (int n = 0; n < 6; ++n) EXPECT_EQ(digest_through_it(), expected) << "one server has ended";
}

/// A server that was killed counts as alive for 5 s.
TEST_F(NodesTrials, ARequestWaitsUntilTheSessionOfADeadServerIsFree) {
    auto a = start("a");
    const auto b = start("b");
    simulate(a->robot_address(), "300");
    const auto before = digest(*a);
    EXPECT_EQ(digest(*b), before);
    end(*a, SIGKILL);
    EXPECT_EQ(digest(*b), before);
}

TEST_F(NodesTrials, ARequestAndAViewerDoNotWaitForAPausedServer) {
    const auto a = start("a");
    const auto b = start("b");
    simulate(a->robot_address(), "300");
    const auto before = digest(*b);
    testing_support::LiveClient viewer(b->http_port(), "one");
    EXPECT_TRUE(viewer.read());
    a->process().signal(SIGSTOP);
    EXPECT_EQ(digest(*b), before);
    static_cast<void>(viewer.read_to_the_end());
    a->process().signal(SIGCONT);
}

TEST_F(NodesTest, RobotsFindTheServerThatHasTheirSession) {
    const auto a = start("a");
    auto b = start("b");
    simulate(a->robot_address(), "200");
    simulate(b->robot_address(), "300"); // b names a
    const auto whole = digest(*a);
    end(*a, SIGKILL);
    const auto c = start("a");
    end(*c, SIGTERM);
    simulate(a->robot_address() + "," + c->robot_address() + "," + b->robot_address(), "300");
    EXPECT_EQ(digest(*b), whole) << "all scans are there once";
}

/// The robot knows the first server only.
TEST_F(NodesTest, AServerThatStopsNamesTheOneThatGoesOn) {
    const auto a = start("a");
    const auto b = start("b");
    const auto known = [&] { return a->get_json("/api/v1/nodes").at("nodes").as_array(); };
    while (known().size() < 2 || known().at(1).at("robots").as_string() != b->robot_address()) { // a second later
    }
    auto robot = start_robot(a->robot_address(), "200", "20"); // of 10 scans a second
    while (a->get("/api/v1/sessions/one").status != 200) {
    }
    end(*a, SIGTERM);
    expect_done(std::move(robot));
    EXPECT_EQ(b->get_json("/api/v1/sessions/one").at("scans"), 200);
}

} // namespace
} // namespace scanloom::test
