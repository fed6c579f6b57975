#include "server/http/server.hpp"

#include "tests/support/http_client.hpp"
#include "tests/unit/server/http/running_http.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

namespace scanloom::http {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::HttpClient;

TEST(HttpServer, SlowHeadersAreCutOff) {
    RunningHttp server(ServerConfig{.header = 50ms});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: loc");
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, SlowBytesDoNotPostponeTheDeadline) {
    RunningHttp server(ServerConfig{.header_bytes_max = 1U << 30, .header = 50ms}); // so that only time can end it
    HttpClient client(server.port());
    client.send("GET /");
    const std::jthread dripping([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) client.send("x");
    });
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, StalledBodyIsCutOffBeforeItsDeadline) {
    RunningHttp server(ServerConfig{.body = 1h, .body_pause = 50ms});
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 5\r\n\r\nhel");
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, AnnouncedLengthDoesNotExtendTheDeadline) {
    RunningHttp server(ServerConfig{.body = 50ms, .body_pause = 1h, .read_rate_min = 100});
    HttpClient client(server.port());
    client.send(
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 200000\r\n\r\nhello");
    EXPECT_TRUE(client.is_closed()); // after 0.1 s, not after more than half an hour
}

TEST(HttpServer, IdleConnectionsAreClosed) {
    RunningHttp server(ServerConfig{.idle = 250ms}); // long enough for a request on a busy machine
    HttpClient fresh(server.port());
    EXPECT_TRUE(fresh.is_closed());
    HttpClient used(server.port());
    used.send(get("/"));
    EXPECT_EQ(used.read().status, 200);
    EXPECT_TRUE(used.is_closed());
}

TEST(HttpServer, ClientThatDoesNotReadIsCutOff) {
    std::promise<void> entered;
    RunningHttp server(ServerConfig{.write = 50ms, .drain = 1h}, [&](const Request&) {
        entered.set_value();
        return ok("text/plain", Body(std::string(64 << 20, 'a'))); // more than the sockets' buffers hold
    });
    HttpClient client(server.port());
    client.send(get("/"));
    entered.get_future().wait();
    server.stop(); // returns when the connection is closed, although no byte was read
}

TEST(HttpServer, ClientThatDoesNotCloseIsCutOff) {
    RunningHttp server(ServerConfig{.linger = 50ms, .drain = 1h});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(client.read().status, 200);
    server.stop(); // returns when the connection is closed
}

TEST(HttpServer, UnfinishedRequestIsCutOffAfterDraining) {
    RunningHttp server(ServerConfig{.header = 1h, .drain = 50ms});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: loc");
    HttpClient other(server.port());
    other.send(get("/"));
    EXPECT_EQ(other.read().status, 200); // so the first has been accepted
    server.stop();                       // returns when the connection is closed
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, SlowReaderIsCutOff) {
    constexpr std::size_t kSize = 64 << 20; // seconds of slow reading
    RunningHttp server(ServerConfig{.write = 50ms, .write_rate_min = std::uint64_t{1} << 40},
                       [](const Request&) { return ok("text/plain", Body(std::string(kSize, 'a'))); });
    HttpClient client(server.port());
    client.send(get("/"));
    EXPECT_LT(client.read_slowly(), kSize);
}

TEST(HttpServer, LargeResponsesArriveComplete) {
    RunningHttp server({}, [](const Request&) { return ok("text/plain", Body(std::string(8 << 20, 'b'))); });
    EXPECT_EQ(answer_to(server, get("/")).body, std::string(8 << 20, 'b'));
}

TEST(HttpServer, ExceptionFailsOneRequestOnly) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send(get("/throw"));
    const auto answer = client.read();
    EXPECT_EQ(answer.status, 500);
    EXPECT_THAT(answer.body, Not(HasSubstr("asked to"))); // the reason is only logged
    client.send(get("/"));
    EXPECT_EQ(client.read().status, 200);
}

TEST(HttpServer, ExcessConnectionGetsAResponse) {
    std::promise<void> entered;
    std::promise<void> go_on;
    RunningHttp server(ServerConfig{.connections_max = 1}, [&](const Request& request) {
        entered.set_value();
        go_on.get_future().wait();
        return echo(request);
    });
    HttpClient first(server.port());
    first.send(get("/api/v1/sessions"));
    entered.get_future().wait();
    HttpClient second(server.port());
    EXPECT_EQ(second.read().status, 503);
    EXPECT_EQ(server.counters().connections_refused.Value(), 1.0);
    go_on.set_value();
    EXPECT_EQ(first.read().status, 200);
}

TEST(HttpServer, SilentConnectionIsReplaced) {
    RunningHttp server(ServerConfig{.connections_max = 3});
    HttpClient silent(server.port());
    HttpClient silent_too(server.port());
    HttpClient stammering(server.port());
    stammering.send("GET / HT");
    std::vector<std::unique_ptr<HttpClient>> guests;
    for (int n = 0; n < 3; ++n) {
        guests.push_back(std::make_unique<HttpClient>(server.port()));
        guests.back()->send(get("/"));
        EXPECT_EQ(guests.back()->read().status, 200);
    }
    for (const auto& earlier : {&silent, &silent_too, &stammering}) EXPECT_TRUE(earlier->is_closed());
    for (const auto& guest : guests) {
        guest->send(get("/"));
        EXPECT_EQ(guest->read().status, 200);
    }
    EXPECT_EQ(server.counters().connections_refused.Value(), 0.0);
}

TEST(MayConnect, BoundsEachAddressExceptLoopbackAndProxies) {
    const auto address = [](const char* text) { return boost::asio::ip::make_address(text); };
    const ServerConfig config{.connections_per_peer_max = 2, .proxies = {address("192.0.2.7")}};
    EXPECT_TRUE(may_connect(address("192.0.2.1"), 1, config));
    EXPECT_FALSE(may_connect(address("192.0.2.1"), 2, config));
    EXPECT_FALSE(may_connect(address("2001:db8::1"), 2, config));
    for (const auto* free : {"192.0.2.7", "::ffff:192.0.2.7", "127.0.0.1", "::ffff:127.0.0.1", "::1"})
        EXPECT_TRUE(may_connect(address(free), 2, config)) << free;
}

TEST(HttpServer, NewConnectionsReplaceSlowBodies) {
    RunningHttp server(ServerConfig{.connections_max = 2});
    std::array<HttpClient, 2> slow{HttpClient(server.port()), HttpClient(server.port())};
    for (auto& client : slow) {
        client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nExpect: "
                    "100-continue\r\nContent-Length: 9\r\n\r\n");
        EXPECT_EQ(client.read().status, 100);
        client.send("a");
    }
    std::array<HttpClient, 2> fresh{HttpClient(server.port()), HttpClient(server.port())};
    for (auto& client : fresh) {
        client.send(get("/livez"));
        EXPECT_EQ(client.read().status, 200);
    }
    for (auto& client : slow) EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, NewConnectionReplacesASlowReader) {
    std::promise<void> entered;
    RunningHttp server(ServerConfig{.connections_max = 1, .write = 1h}, [&](const Request& request) {
        if (request.target != "/large") return echo(request);
        entered.set_value();
        return ok("text/plain", Body(std::string(64 << 20, 'a'))); // more than the sockets' buffers hold
    });
    HttpClient reader(server.port());
    reader.send(get("/large"));
    entered.get_future().wait();
    auto answer = answer_to(server, get("/livez"));
    constexpr int kAttemptsMax = 20'000; // while the response is computed, the reader waits for the server
    for (int attempt = 1; answer.status != 200 && attempt < kAttemptsMax; ++attempt)
        answer = answer_to(server, get("/livez"));
    EXPECT_EQ(answer.status, 200);
}

TEST(HttpServer, StopFinishesRunningRequests) {
    std::promise<void> entered;
    std::promise<void> go_on;
    RunningHttp server({}, [&](const Request& request) {
        entered.set_value();
        go_on.get_future().wait();
        return echo(request);
    });
    HttpClient busy(server.port());
    HttpClient idle(server.port());
    busy.send(get("/api/v1/sessions"));
    entered.get_future().wait();
    std::promise<void> done;
    server.server().stop([&done] { done.set_value(); });
    EXPECT_TRUE(idle.is_closed()); // at once, while the other is still served
    go_on.set_value();
    EXPECT_EQ(busy.read().status, 200); // the server may not have marked it as the last one yet
    EXPECT_TRUE(busy.is_closed());
    busy.shutdown_send();
    done.get_future().wait();
    server.set_stopped();
}

/// Blocks the selected requests until its destruction.
class Authenticator {
public:
    explicit Authenticator(int awaited) : awaited_(awaited) {}

    void pass_slowly() {
        if (--awaited_ == 0) all_in_.set_value();
        opened_.wait(false);
    }
    void wait_until_all_are_in() { all_in_.get_future().wait(); }
    void open() {
        opened_ = true;
        opened_.notify_all();
    }

private:
    std::atomic<int> awaited_;
    std::promise<void> all_in_;
    std::atomic<bool> opened_ = false;
};

std::string post(std::string_view target) {
    return fmt::format("POST {} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {}\r\nContent-Length: 0\r\n\r\n", target,
                       target.ends_with("/import") ? "multipart/form-data" : "application/json");
}

TEST(HttpServer, HealthAndViewerAreServedWhenPoolsAreBusy) {
    Authenticator authenticator(3);
    RunningHttp server({}, [&](const Request& request) {
        if (request.target.starts_with("/api") || request.target == "/metrics") authenticator.pass_slowly();
        return echo(request);
    });
    std::vector<std::unique_ptr<HttpClient>> busy;
    for (const auto& request : {get("/api/v1/sessions"), post("/api/v1/sessions"), get("/metrics")}) {
        busy.push_back(std::make_unique<HttpClient>(server.port()));
        busy.back()->send(request);
    }
    authenticator.wait_until_all_are_in(); // no executor has a thread left
    for (const auto* target : {"/livez", "/readyz", "/", "/assets/a.js", "/openapi.json", "/nothing"}) {
        EXPECT_EQ(answer_to(server, get(target)).status, 200) << target;
    }
    authenticator.open();
    for (const auto& client : busy) EXPECT_EQ(client->read().status, 200);
}

TEST(HttpServer, ExcessRequestOfAPoolIsRefusedWithoutDelayingOthers) {
    struct Kind {
        ServerConfig config;
        std::string taken;    ///< takes the only permit of its class of work
        std::string refused;  ///< needs the same permit
        std::string answered; ///< needs none
    };
    const std::string session = "/api/v1/sessions/s";
    const std::vector<Kind> kinds = {
        {{.changes_max = 1}, post("/api/v1/sessions"), post("/api/v1/backups"), get("/api/v1/sessions")},
        {{.paths_max = 1}, get(session + "/trajectory.geojson"), get(session + "/points.csv"), get(session + "/log")},
        {{.plans_max = 1}, post(session + "/plan"), post(session + "/goal"), get(session + "/map.png")},
        {{.imports_max = 1}, post(session + "/import"), post("/api/v1/sessions/t/import"), get("/api/v1/sessions")},
    };
    for (const auto& kind : kinds) {
        SCOPED_TRACE(kind.taken);
        Authenticator authenticator(1);
        RunningHttp server(kind.config, [&](const Request& request) {
            if (kind.taken.starts_with(request.method + " " + request.target + " ")) authenticator.pass_slowly();
            return echo(request);
        });
        HttpClient first(server.port());
        first.send(kind.taken);
        authenticator.wait_until_all_are_in();
        auto refused = answer_to(server, kind.refused);
        EXPECT_EQ(refused.status, 503);
        EXPECT_EQ(refused.fields["retry-after"], "1");
        EXPECT_EQ(answer_to(server, kind.answered).status, 200);
        authenticator.open();
        EXPECT_EQ(first.read().status, 200);
        EXPECT_EQ(answer_to(server, kind.refused).status, 200);
    }
}

TEST(HttpServer, PortInUseIsAnError) {
    RunningHttp server;
    ServerConfig config;
    config.endpoint = {boost::asio::ip::address_v4::loopback(), server.port()};
    const auto second = Server::listen(server.io(), server.api(), config, server.counters());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::kUnreachable);
    EXPECT_THAT(second.error().message, HasSubstr(fmt::format("127.0.0.1:{}", server.port())));
}

TEST(HttpServer, CountsResponsesByStatusClass) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, get("/")).status, 200);
    EXPECT_EQ(answer_to(server, "garbage\r\n\r\n").status, 400);
    EXPECT_EQ(answer_to(server, get("/throw")).status, 500);
    EXPECT_EQ(server.counters().answered(200).Value(), 1.0);
    EXPECT_EQ(server.counters().answered(404).Value(), 1.0);
    EXPECT_EQ(server.counters().answered(500).Value(), 1.0);
}

} // namespace
} // namespace scanloom::http
