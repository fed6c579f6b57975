#include "tests/support/http_client.hpp"
#include "tests/unit/server/http/running_http.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

/// Valid and invalid requests of the server.
namespace scanloom::http {
namespace {

using testing::HasSubstr;
using testing_support::HttpClient;

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
    const std::string request =
        "POST /a HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 5\r\n\r\nhello";
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

TEST(HttpServer, OtherProtocolsAreBadRequests) {
    RunningHttp server;
    for (const auto* bytes :
         {"\x16\x02garbage\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n",
          "GET / HTTP/1.1\r\nHost : x\r\n\r\n",
          "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: x\r\n\r\n",
          "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
          "1\r\nContent-Length: 2\r\n\r\n"}) {
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

TEST(HttpServer, TlsClientOnAPlainPortIsClosedInOrder) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("\x16\x03\x01\x02\x01garbage\r\n\r\n");
    EXPECT_EQ(client.read().status, 0) << "the client could not read a plain response";
    EXPECT_TRUE(client.ends_in_order());
}

TEST(HttpServer, RobotsAreReferredToTheRobotPort) {
    RunningHttp server;
    const std::string_view frame("\0\0\0\x08\x12\x06robot1", 12);
    const auto answer = answer_to(server, frame);
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, HasSubstr("robot port"));
}

TEST(HttpServer, ExactlyOneHostFieldIsRequired) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\n\r\n").status, 400);
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n").status, 400);
}

TEST(HttpServer, UnknownHostsAreMisdirectedAndLogged) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421);
    EXPECT_EQ(answer_to(server, "GET / HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n").status, 200);
    EXPECT_EQ(server.refusals(auth::Reason::kForeignHost), 1.0);
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

TEST(HttpServer, HeadersUpToTheLimitAreAccepted) {
    RunningHttp server;
    EXPECT_EQ(answer_to(server, get("/" + std::string(8'200, 'a'))).status, 431);
    EXPECT_EQ(answer_to(server, get("/" + std::string(7'000, 'a'))).status, 200);
}

TEST(HttpServer, OversizedBodiesAreRefusedBeforeReading) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send(
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 262145\r\n\r\n");
    const auto refused = client.read();
    EXPECT_EQ(refused.status, 413);
    EXPECT_THAT(refused.body, testing::HasSubstr("at most 262144 bytes"));
    HttpClient eager(server.port());
    eager.send(
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 300000\r\n\r\n" +
        std::string(300'000, 'a'));
    EXPECT_EQ(eager.read().status, 413);
    EXPECT_TRUE(eager.ends_in_order()); // a reset might overtake the response because the client continues to send
}

TEST(HttpServer, BodiesUpToTheLimitAreAccepted) {
    RunningHttp server;
    const std::string body(262'144, 'a');
    const auto answer = answer_to(
        server,
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 262144\r\n\r\n" +
            body);
    EXPECT_EQ(answer.body, "POST / " + body);
}

std::string chunked(std::string_view chunks, std::string_view fields = "") {
    return fmt::format("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nTransfer-Encoding: "
                       "chunked\r\n{}\r\n{}",
                       fields, chunks);
}

TEST(HttpServer, ChunkedBodiesUpToTheLimitAreAccepted) {
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
    EXPECT_EQ(
        answer_to(
            server,
            "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nTransfer-Encoding: gzip\r\n\r\n")
            .status,
        501);
    EXPECT_EQ(answer_to(server, "POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n").status, 400);
    EXPECT_EQ(answer_to(server, chunked("nonsense\r\n")).status, 400);
    EXPECT_EQ(answer_to(server, get("/")).status, 200);
}

TEST(HttpServer, ContentEncodingAndDuplicateContentTypeAreRefused) {
    RunningHttp server;
    const auto with = [&](std::string_view fields) {
        return answer_to(
            server,
            fmt::format(
                "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 2\r\n{}\r\nok",
                fields));
    };
    const auto refused = with("Content-Encoding: gzip\r\n");
    EXPECT_EQ(refused.status, 415);
    EXPECT_EQ(refused.fields.at("accept-encoding"), "identity");
    EXPECT_EQ(with("Content-Encoding: identity\r\n").status, 200);
    EXPECT_EQ(with("Content-Encoding: identity\r\nContent-Encoding: gzip\r\n").status, 415);
    EXPECT_EQ(with("Content-Type: text/plain\r\n").status, 400);
}

TEST(HttpServer, AbsoluteTargetReplacesTheHost) {
    RunningHttp server;
    const auto ask = [&](std::string_view target, std::string_view host) {
        return answer_to(server, fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", target, host));
    };
    EXPECT_EQ(ask("http://localhost:8080/a/b?c=d", "localhost").body, "GET /a/b?c=d ");
    EXPECT_EQ(ask("HTTP://localhost", "localhost").body, "GET / ");
    EXPECT_EQ(ask("http://localhost?c=d", "localhost").body, "GET /?c=d ");
    EXPECT_EQ(ask("http://localhost/", "evil.example").status, 200) << "the Host field does not count";
    EXPECT_EQ(ask("http://evil.example/", "localhost").status, 421);
    EXPECT_EQ(ask("http:///", "localhost").status, 400) << "no host: parse_target() refuses it";
    EXPECT_EQ(ask("http:///", "evil.example").status, 421);
}

TEST(HttpServer, EmptyLineBeforeARequestIsSkipped) {
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

TEST(HttpServer, Http10ConnectionIsKeptOnRequest) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("GET /a HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_EQ(client.read().fields.at("connection"), "keep-alive");
    client.send("GET /b HTTP/1.0\r\n\r\n");
    EXPECT_EQ(client.read().fields.at("connection"), "close");
    EXPECT_TRUE(client.ends_in_order());
}

TEST(HttpServer, ExpectContinueIsAnswered) {
    RunningHttp server;
    HttpClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nExpect: "
                "100-continue\r\nContent-Length: 2\r\n\r\n");
    EXPECT_EQ(client.read().status, 100);
    client.send("ok");
    EXPECT_EQ(client.read().body, "POST / ok");
}

} // namespace
} // namespace scanloom::http
