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
using testing_support::HttpAnswer;
using testing_support::HttpClient;

HttpAnswer answer_to(RunningHttp& server, std::string_view bytes) {
    HttpClient client(server.port());
    client.send(bytes);
    return client.read();
}

TEST(HttpServer, AnswersRequestsOnOneConnectionInOrder) {
    RunningHttp server;
    HttpClient client(server.port());
    for (int i = 0; i < 3; ++i) {
        client.send(get(fmt::format("/{}", i)));
        const auto answer = client.read();
        EXPECT_EQ(answer.status, 200);
        EXPECT_EQ(answer.body, fmt::format("GET /{} ", i));
        EXPECT_FALSE(answer.fields.contains("connection"));
    }
}

TEST(HttpServer, PipelinedRequestsAreAllAnsweredInOrder) {
    RunningHttp server;
    HttpClient client(server.port());
    std::string bytes;
    for (int i = 0; i < 300; ++i) bytes += get(fmt::format("/{}", i)); // more than the buffer holds at once
    client.send(bytes);
    for (int i = 0; i < 300; ++i) ASSERT_EQ(client.read().body, fmt::format("GET /{} ", i));
}

TEST(HttpServer, RequestsSplitAtEveryByteAreUnderstood) {
    RunningHttp server;
    HttpClient client(server.port());
    const std::string request = "POST /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello";
    for (const char c : request + get("/b")) client.send(std::string_view(&c, 1));
    EXPECT_EQ(client.read().body, "POST /a hello");
    EXPECT_EQ(client.read().body, "GET /b ");
}

TEST(HttpServer, HeadHasTheLengthButNotTheBody) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("HEAD /a HTTP/1.1\r\nHost: localhost\r\n\r\n" + get("/b"));
    const auto head = client.read(false);
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.fields.at("content-length"), "8");
    EXPECT_EQ(client.read().body, "GET /b ");
}

TEST(HttpServer, ConnectionIsClosedWhenAskedFor) {
    RunningHttp server;
    for (const auto* request :
         {"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", "GET / HTTP/1.0\r\n\r\n"}) {
        HttpClient client(server.port());
        client.send(request);
        const auto answer = client.read();
        EXPECT_EQ(answer.status, 200);
        EXPECT_EQ(answer.fields.at("connection"), "close");
        EXPECT_TRUE(client.is_closed());
    }
}

TEST(HttpServer, WhatIsNotHttpIsABadRequest) {
    RunningHttp server;
    for (const auto* bytes :
         {"\x16\x02garbage\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n",
          "GET / HTTP/1.1\r\nHost : x\r\n\r\n", "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: x\r\n\r\n",
          "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n"}) {
        HttpClient client(server.port());
        client.send(bytes);
        const auto answer = client.read();
        EXPECT_EQ(answer.status, 400) << bytes;
        EXPECT_EQ(answer.fields.at("content-type"), "application/problem+json");
        EXPECT_EQ(answer.fields.at("connection"), "close");
        EXPECT_TRUE(client.is_closed());
    }
    EXPECT_EQ(answer_to(server, get("/")).status, 200);
}

TEST(HttpServer, WhoGreetsInTlsWhereThereIsNoneIsLeftInOrder) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("\x16\x03\x01\x02\x01garbage\r\n\r\n");
    EXPECT_EQ(client.read().status, 0) << "whatever were said could not be read there";
    EXPECT_TRUE(client.ends_in_order());
}

TEST(HttpServer, RobotsAreSentToTheirPort) {
    RunningHttp server;
    const std::string_view frame("\0\0\0\x08\x12\x06robot1", 12);
    const auto answer = answer_to(server, frame);
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, HasSubstr("robot port"));
}

TEST(HttpServer, OneHostFieldIsNeeded) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\n\r\n").status, 400);
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n").status, 400);
}

TEST(HttpServer, HostsOfStrangersAreMisdirectedAndTold) {
    std::atomic<int> told = 0;
    Answering answering{echo};
    answering.foreign_host = [&](const std::string& who) { told += who == "127.0.0.1" ? 1 : 100; };
    RunningHttp server({}, answering);
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421);
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n").status, 200);
    EXPECT_EQ(told, 1);
}

TEST(HttpServer, OversizedHeadersAreRefused) {
    RunningHttp server;
    const std::string one_field = "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'a') + "\r\n\r\n";
    EXPECT_EQ(answer_to(server, one_field).status, 431);
    std::string many_fields = "GET / HTTP/1.1\r\nHost: localhost\r\n";
    for (int i = 0; i < 5'000; ++i) many_fields += "X: a\r\n";
    EXPECT_EQ(answer_to(server, many_fields).status, 431);
    EXPECT_EQ(answer_to(server, get("/" + std::string(100'000, 'a'))).status, 431);
}

TEST(HttpServer, HeadersUpToTheLimitAreRead) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, get("/" + std::string(8'200, 'a'))).status, 431);
    EXPECT_EQ(answer_to(server, get("/" + std::string(7'000, 'a'))).status, 200);
}

TEST(HttpServer, OversizedBodiesAreRefusedBeforeTheyAreRead) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 262145\r\n\r\n");
    const auto refused = client.read();
    EXPECT_EQ(refused.status, 413);
    EXPECT_THAT(refused.body, testing::HasSubstr("at most 262144 bytes"));
    HttpClient eager(server.port());
    eager.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 300000\r\n\r\n" + std::string(300'000, 'a'));
    EXPECT_EQ(eager.read().status, 413);
    EXPECT_TRUE(eager.ends_in_order()); // a reset might overtake the answer, as its sender went on sending
}

TEST(HttpServer, BodiesUpToTheLimitAreRead) {
    RunningHttp server;
    const std::string body(262'144, 'a');
    const auto answer =
        answer_to(server, "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 262144\r\n\r\n" + body);
    EXPECT_EQ(answer.body, "POST / " + body);
}

std::string chunked(std::string_view chunks, std::string_view fields = "") {
    return fmt::format("POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n{}\r\n{}", fields, chunks);
}

TEST(HttpServer, ChunkedBodiesAreReadUpToTheLimit) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send(chunked("5\r\nhello\r\n6;name=value\r\n world\r\n0\r\n\r\n") + get("/next"));
    EXPECT_EQ(client.read().body, "POST / hello world");
    EXPECT_EQ(client.read().body, "GET /next ");
    HttpClient slow(server.port());
    for (const char c : chunked("5\r\nhello\r\n0\r\n\r\n")) slow.send(std::string(1, c));
    EXPECT_EQ(slow.read().body, "POST / hello");

    const std::string half(131'072, 'a');
    const std::string two_chunks = fmt::format("20000\r\n{0}\r\n20000\r\n{0}\r\n", half);
    EXPECT_EQ(answer_to(server, chunked(two_chunks + "0\r\n\r\n")).body, "POST / " + half + half);
    EXPECT_EQ(answer_to(server, chunked(two_chunks + "1\r\na\r\n0\r\n\r\n")).status, 413);
    EXPECT_EQ(answer_to(server, chunked("ffffffffffffffff\r\n")).status, 413);
}

TEST(HttpServer, OtherTransferEncodingsAndTrailersAreRefused) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, chunked("0\r\nX: a\r\n\r\n")).status, 400);
    EXPECT_EQ(answer_to(server, chunked("0\r\nX: " + std::string(70'000, 'a') + "\r\n\r\n")).status, 431);
    EXPECT_EQ(answer_to(server, chunked("5\r\nhello\r\n0\r\n\r\n", "Content-Length: 5\r\n")).status, 400);
    EXPECT_EQ(answer_to(server, "POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: gzip\r\n\r\n").status, 501);
    EXPECT_EQ(answer_to(server, "POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n").status, 400);
    EXPECT_EQ(answer_to(server, chunked("nonsense\r\n")).status, 400);
    EXPECT_EQ(answer_to(server, get("/")).status, 200);
}

TEST(HttpServer, BodiesInAnotherCodingAndContentTypesGivenTwiceAreRefused) {
    RunningHttp server;
    const auto with = [&](std::string_view fields) {
        return answer_to(server,
                         fmt::format("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n{}\r\nok", fields));
    };
    const auto refused = with("Content-Encoding: gzip\r\n");
    EXPECT_EQ(refused.status, 415);
    EXPECT_EQ(refused.fields.at("accept-encoding"), "identity");
    EXPECT_EQ(with("Content-Encoding: identity\r\n").status, 200);
    EXPECT_EQ(with("Content-Encoding: identity\r\nContent-Encoding: gzip\r\n").status, 415);
    EXPECT_EQ(with("Content-Type: text/plain\r\nContent-Type: application/json\r\n").status, 400);
}

TEST(HttpServer, AbsoluteTargetsAreReadWithTheirOwnHost) {
    RunningHttp server;
    const auto ask = [&](std::string_view target, std::string_view host) {
        return answer_to(server, fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", target, host));
    };
    EXPECT_EQ(ask("http://localhost:8080/a/b?c=d", "localhost").body, "GET /a/b?c=d ");
    EXPECT_EQ(ask("HTTP://localhost", "localhost").body, "GET / ");
    EXPECT_EQ(ask("http://localhost?c=d", "localhost").body, "GET /?c=d ");
    EXPECT_EQ(ask("http://localhost/", "evil.example").status, 200) << "the Host field does not count";
    EXPECT_EQ(ask("http://evil.example/", "localhost").status, 421);
    EXPECT_EQ(ask("http:///", "localhost").status, 200) << "no host: it stays as it is, for parse_target() to refuse";
    EXPECT_EQ(ask("http:///", "evil.example").status, 421);
}

TEST(HttpServer, OneEmptyLineBeforeARequestIsSkipped) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("\r\n" + get("/a") + "\r\n" + get("/b"));
    EXPECT_EQ(client.read().body, "GET /a ");
    EXPECT_EQ(client.read().body, "GET /b ");
    client.send("\r");
    client.send("\n" + get("/c"));
    EXPECT_EQ(client.read().body, "GET /c ");
    EXPECT_EQ(answer_to(server, "\r\n\r\n" + get("/")).status, 400);
}

TEST(HttpServer, ClientsOfHttp10KeepTheConnectionWhenTheyAskForIt) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("GET /a HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_EQ(client.read().fields.at("connection"), "keep-alive");
    client.send("GET /b HTTP/1.0\r\n\r\n");
    EXPECT_EQ(client.read().fields.at("connection"), "close");
    EXPECT_TRUE(client.ends_in_order());
}

TEST(HttpServer, AWaitingBodyIsAskedFor) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n");
    EXPECT_EQ(client.read().status, 100);
    client.send("ok");
    EXPECT_EQ(client.read().body, "POST / ok");
}

TEST(HttpServer, SlowHeadersAreCutOff) {
    RunningHttp server(ServerConfig{.header = 50ms});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: loc");
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, DrippingBytesDoNotPostponeTheDeadline) {
    RunningHttp server(ServerConfig{.header_bytes_max = 1U << 30, .header = 50ms}); // so that only time can end it
    HttpClient client(server.port());
    client.send("GET /");
    const std::jthread dripping([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) client.send("x");
    });
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, ABodyThatStopsComingIsCutOffThoughItsTimeIsNotOver) {
    RunningHttp server(ServerConfig{.body = 1h, .body_pause = 50ms});
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhel");
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, AnAnnouncedLengthGivesNoTimeBeforeItIsSent) {
    RunningHttp server(ServerConfig{.body = 50ms, .body_pause = 1h, .read_rate_min = 100});
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 200000\r\n\r\nhello");
    EXPECT_TRUE(client.is_closed()); // after 0.1 s, not after more than half an hour
}

TEST(HttpServer, IdleConnectionsAreClosed) {
    RunningHttp server(ServerConfig{.idle = 50ms});
    HttpClient fresh(server.port());
    EXPECT_TRUE(fresh.is_closed());
    HttpClient used(server.port());
    used.send(get("/"));
    EXPECT_EQ(used.read().status, 200);
    EXPECT_TRUE(used.is_closed());
}

TEST(HttpServer, WhoDoesNotReadIsCutOff) {
    std::promise<void> entered;
    RunningHttp server(ServerConfig{.write = 50ms, .drain = 1h}, [&](const Request&) {
        entered.set_value();
        return ok("text/plain", Body(std::string(64 << 20, 'a'))); // more than the sockets' buffers hold
    });
    HttpClient client(server.port());
    client.send(get("/"));
    entered.get_future().wait();
    server.stop(); // returns when the connection is closed, though nobody read a byte
}

TEST(HttpServer, WhoDoesNotHangUpAfterTheLastAnswerIsHungUpOn) {
    RunningHttp server(ServerConfig{.linger = 50ms, .drain = 1h});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(client.read().status, 200);
    server.stop(); // returns when the connection is closed
}

TEST(HttpServer, WhoIsNotReadyWhenDrainingIsOverIsCutOff) {
    RunningHttp server(ServerConfig{.header = 1h, .drain = 50ms});
    HttpClient client(server.port());
    client.send("GET / HTTP/1.1\r\nHost: loc");
    HttpClient other(server.port());
    other.send(get("/"));
    EXPECT_EQ(other.read().status, 200); // so the first has been accepted
    server.stop();                       // returns when the connection is closed
    EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, WhoReadsTooSlowlyIsCutOff) {
    constexpr std::size_t kSize = 64 << 20; // seconds of slow reading
    RunningHttp server(ServerConfig{.write = 50ms, .write_rate_min = std::uint64_t{1} << 40},
                       [](const Request&) { return ok("text/plain", Body(std::string(kSize, 'a'))); });
    HttpClient client(server.port());
    client.send(get("/"));
    EXPECT_LT(client.read_slowly(), kSize);
}

TEST(HttpServer, LargeAnswersArriveWhole) {
    RunningHttp server({}, [](const Request&) { return ok("text/plain", Body(std::string(8 << 20, 'b'))); });
    EXPECT_EQ(answer_to(server, get("/")).body, std::string(8 << 20, 'b'));
}

TEST(HttpServer, AFaultCostsOneAnswerOnly) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send(get("/throw"));
    const auto answer = client.read();
    EXPECT_EQ(answer.status, 500);
    EXPECT_THAT(answer.body, Not(HasSubstr("asked to"))); // the reason is the log's
    client.send(get("/"));
    EXPECT_EQ(client.read().status, 200);
}

TEST(HttpServer, OneConnectionTooManyIsTold) {
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

TEST(HttpServer, NobodyKeepsAPlaceBySayingNothing) {
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

TEST(HttpServer, NewConnectionsGetThePlacesOfSlowBodies) {
    RunningHttp server(ServerConfig{.connections_max = 2});
    std::array<HttpClient, 2> slow{HttpClient(server.port()), HttpClient(server.port())};
    for (auto& client : slow) {
        client.send("POST / HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 9\r\n\r\n");
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

TEST(HttpServer, ANewConnectionGetsThePlaceOfASlowReader) {
    RunningHttp server(ServerConfig{.connections_max = 1}, [](const Request& request) {
        return ok("text/plain", Body(std::string(request.target == "/large" ? 64 << 20 : 1, 'a')));
    });
    HttpClient reader(server.port());
    reader.send(get("/large"));
    HttpClient fresh(server.port());
    fresh.send(get("/livez"));
    auto answer = fresh.read();
    while (answer.status != 200) answer = answer_to(server, get("/livez")); // while the reader's answer is being made
    EXPECT_EQ(answer.status, 200);
}

TEST(HttpServer, StoppingFinishesWhatIsUnderWay) {
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
    EXPECT_EQ(busy.read().status, 200); // it may not have been told yet that it is the last
    EXPECT_TRUE(busy.is_closed());
    busy.shutdown_send();
    done.get_future().wait();
    server.set_stopped();
}

/// Holds up every request it is told to, until it goes.
class Gate {
public:
    explicit Gate(int awaited) : awaited_(awaited) {}

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
    return fmt::format("POST {} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n", target);
}

TEST(HttpServer, HealthAndTheViewerAreAnsweredWhateverElseIsBusy) {
    Gate gate(3);
    RunningHttp server({}, [&](const Request& request) {
        if (request.target.starts_with("/api") || request.target == "/metrics") gate.pass_slowly();
        return echo(request);
    });
    std::vector<std::unique_ptr<HttpClient>> busy;
    for (const auto& request : {get("/api/v1/sessions"), post("/api/v1/sessions"), get("/metrics")}) {
        busy.push_back(std::make_unique<HttpClient>(server.port()));
        busy.back()->send(request);
    }
    gate.wait_until_all_are_in(); // no executor has a thread left
    for (const auto* target : {"/livez", "/readyz", "/", "/assets/a.js", "/openapi.json", "/nothing"}) {
        EXPECT_EQ(answer_to(server, get(target)).status, 200) << target;
    }
    gate.open();
    for (const auto& client : busy) EXPECT_EQ(client->read().status, 200);
}

TEST(HttpServer, OneTooManyOfAKindIsToldToComeBackAndHoldsUpNothingElse) {
    struct Kind {
        ServerConfig config;
        std::string taken;    ///< takes the only place of its kind
        std::string refused;  ///< needs the same place
        std::string answered; ///< needs none
    };
    const std::string session = "/api/v1/sessions/s";
    const std::vector<Kind> kinds = {
        {{.changes_max = 1}, post("/api/v1/sessions"), post("/api/v1/backups"), get("/api/v1/sessions")},
        {{.weaves_max = 1},
         get(session + "/digest?until=9"),
         get(session + "/map.png?until=8"),
         get(session + "/digest")},
        {{.paths_max = 1}, get(session + "/trajectory.geojson"), get(session + "/points.csv"), get(session + "/log")},
        {{.plans_max = 1}, post(session + "/plan"), post(session + "/goal"), get(session + "/map.png")},
        {{.imports_max = 1}, post(session + "/import"), post("/api/v1/sessions/t/import"), get("/api/v1/sessions")},
    };
    for (const auto& kind : kinds) {
        SCOPED_TRACE(kind.taken);
        Gate gate(1);
        RunningHttp server(kind.config, [&](const Request& request) {
            if (kind.taken.starts_with(request.method + " " + request.target + " ")) gate.pass_slowly();
            return echo(request);
        });
        HttpClient first(server.port());
        first.send(kind.taken);
        gate.wait_until_all_are_in();
        auto refused = answer_to(server, kind.refused);
        EXPECT_EQ(refused.status, 503);
        EXPECT_EQ(refused.fields["retry-after"], "1");
        EXPECT_EQ(answer_to(server, kind.answered).status, 200);
        gate.open();
        EXPECT_EQ(first.read().status, 200);
        EXPECT_EQ(answer_to(server, kind.refused).status, 200);
    }
}

TEST(HttpServer, APortInUseIsAClearError) {
    RunningHttp server;
    ServerConfig config;
    config.endpoint = {boost::asio::ip::address_v4::loopback(), server.port()};
    const auto second = Server::listen(server.io(), server.executors(), config, {echo}, server.counters());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::kUnreachable);
    EXPECT_THAT(second.error().message, HasSubstr(fmt::format("127.0.0.1:{}", server.port())));
}

TEST(HttpServer, CountsAnswersByClass) {
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
