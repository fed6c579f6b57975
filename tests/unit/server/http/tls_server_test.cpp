#include "server/http/server.hpp"

#include "tests/support/temporary_directory.hpp"
#include "tests/support/tls_http_client.hpp"
#include "tests/unit/server/http/running_http.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// The HTTP port with a certificate.
namespace scanloom::http {
namespace {

using namespace std::chrono_literals;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::HttpClient;
using testing_support::TlsHttpClient;
using testing_support::TlsManner;
using testing_support::write_certificate;

class TlsServerTest : public testing::Test {
protected:
    [[nodiscard]] ServerConfig config() const {
        ServerConfig made;
        made.tls = tls_;
        return made;
    }

    TlsManner manner() const { return {.trusted = files_.certificate}; }

    TemporaryDirectory directory_;
    testing_support::CertificateFiles files_ = write_certificate(directory_.path(), "127.0.0.1");
    std::shared_ptr<sockets::PortTls> tls_ = sockets::PortTls::open({files_.certificate, files_.key}).value();
};

TEST_F(TlsServerTest, RespondsLikeThePlainServer) {
    RunningHttp server(config());
    TlsHttpClient client(server.port(), manner());
    ASSERT_TRUE(client.is_trusted());
    for (int i = 0; i < 3; ++i) {
        client.send(get(fmt::format("/{}", i)));
        EXPECT_EQ(client.read().body, fmt::format("GET /{} ", i));
    }
    const std::string body(200'000, 'x'); // several TLS records
    client.send(fmt::format(
        "POST /a HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{}",
        body.size(), body));
    EXPECT_EQ(client.read().body, "POST /a " + body);
}

TEST_F(TlsServerTest, LargeResponsesArriveCompleteWithCloseNotify) {
    RunningHttp server(config(), [](const Request&) { return ok("text/plain", Body(std::string(8 << 20, 'b'))); });
    TlsHttpClient client(server.port(), manner());
    client.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(client.read().body, std::string(8 << 20, 'b'));
    EXPECT_TRUE(client.is_taken_leave_of());
}

TEST_F(TlsServerTest, OnlyTlsRequestsAreSecure) {
    const auto tell = [](const Request& request) { return ok("text/plain", Body(request.is_secure ? "yes" : "no")); };
    RunningHttp server(config(), tell);
    TlsHttpClient client(server.port(), manner());
    client.send(get("/"));
    const auto answer = client.read();
    EXPECT_EQ(answer.body, "yes");
    EXPECT_EQ(answer.fields.at("strict-transport-security"), "max-age=31536000");
    RunningHttp plain({}, tell);
    HttpClient other(plain.port());
    other.send(get("/"));
    const auto plainly = other.read();
    EXPECT_EQ(plainly.body, "no");
    EXPECT_FALSE(plainly.fields.contains("strict-transport-security"));
}

TEST_F(TlsServerTest, PlainHttpGetsAPlainResponse) {
    RunningHttp server(config());
    HttpClient client(server.port());
    client.send(get("/"));
    const auto answer = client.read();
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, HasSubstr("https://"));
    EXPECT_FALSE(answer.fields.contains("strict-transport-security")) << "browsers ignore it over plain HTTP";
    EXPECT_TRUE(client.ends_in_order());
}

TEST_F(TlsServerTest, OtherProtocolsAreClosed) {
    RunningHttp server(config());
    HttpClient client(server.port());
    client.send(std::string(64, '\0'));
    EXPECT_EQ(client.read().status, 0);
}

TEST_F(TlsServerTest, UnfinishedHandshakeIsCutOff) {
    auto limits = config();
    limits.handshake = 50ms;
    RunningHttp server(limits);
    HttpClient silent(server.port());
    HttpClient slow(server.port());
    slow.send(std::string_view("\x16\x03\x01\x02\x00\x01", 6));
    EXPECT_TRUE(silent.is_closed());
    EXPECT_TRUE(slow.is_closed());
}

TEST_F(TlsServerTest, UnfinishedHandshakeDoesNotDelayOthers) {
    auto limits = config();
    limits.handshake = 1h;
    RunningHttp server(limits);
    HttpClient slow(server.port());
    slow.send(std::string_view("\x16\x03\x01\x02\x00\x01", 6));
    TlsHttpClient quick(server.port(), manner());
    quick.send(get("/"));
    EXPECT_EQ(quick.read().status, 200);
}

TEST_F(TlsServerTest, ClientWithoutCloseNotifyIsCutOff) {
    auto limits = config();
    limits.linger = 50ms;
    limits.drain = 1h;
    RunningHttp server(limits);
    TlsHttpClient client(server.port(), manner());
    client.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(client.read().status, 200);
    server.stop(); // returns when the connection is closed
}

TEST_F(TlsServerTest, StopDoesNotWaitForHandshakes) {
    auto limits = config();
    limits.handshake = 1h;
    limits.drain = 1h;
    RunningHttp server(limits);
    HttpClient slow(server.port());
    slow.send(std::string_view("\x16\x03\x01\x02\x00\x01", 6));
    TlsHttpClient quick(server.port(), manner()); // accepted after the first one
    ASSERT_TRUE(quick.is_trusted());
    server.stop(); // returns
    EXPECT_TRUE(slow.is_closed());
}

TEST_F(TlsServerTest, OldVersionsAreRefused) {
    RunningHttp server(config());
    auto old = manner();
    old.version_min = TLS1_VERSION;
    old.version_max = TLS1_1_VERSION;
    EXPECT_FALSE(TlsHttpClient(server.port(), old).is_trusted());
    auto twelve = manner();
    twelve.version_max = TLS1_2_VERSION;
    const TlsHttpClient client(server.port(), twelve);
    EXPECT_EQ(client.version(), "TLSv1.2");
    EXPECT_THAT(client.cipher(), AllOf(HasSubstr("ECDHE"), AnyOf(HasSubstr("GCM"), HasSubstr("CHACHA20"))));
    EXPECT_EQ(TlsHttpClient(server.port(), manner()).version(), "TLSv1.3");
}

TEST_F(TlsServerTest, RenegotiationAndTicketsAreRefused) {
    RunningHttp server(config());
    for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
        auto chosen = manner();
        chosen.version_max = version;
        TlsHttpClient client(server.port(), chosen);
        client.send(get("/"));
        EXPECT_EQ(client.read().status, 200);
        EXPECT_FALSE(client.has_ticket()) << version;
        EXPECT_FALSE(client.renegotiate()) << "TLS 1.3 has none";
    }
}

TEST_F(TlsServerTest, CertificatesAreReloadedAndInvalidFilesIgnored) {
    RunningHttp server(config());
    const auto old = manner();
    TlsHttpClient before(server.port(), old);
    const auto kept = directory_.path() / "old.crt";
    std::filesystem::copy_file(files_.certificate, kept);
    std::filesystem::resize_file(files_.certificate, 100);
    const auto broken = tls_->read_again();
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().message, HasSubstr(files_.certificate.string()));
    EXPECT_TRUE(TlsHttpClient(server.port(), {.trusted = kept}).is_trusted()) << "the old certificate stays valid";

    files_ = write_certificate(directory_.path(), "127.0.0.1");
    ASSERT_TRUE(tls_->read_again());
    EXPECT_TRUE(TlsHttpClient(server.port(), manner()).is_trusted());
    EXPECT_FALSE(TlsHttpClient(server.port(), {.trusted = kept}).is_trusted());
    before.send(get("/")); // open connections continue
    EXPECT_EQ(before.read().status, 200);
}

TEST_F(TlsServerTest, UntrustedClientIsRefusedInEveryTlsVersion) {
    const auto known = write_certificate(directory_.path(), "known.example");
    const auto stranger = write_certificate(directory_.path(), "stranger.example");
    const auto expired = write_certificate(directory_.path(), "expired.example", -3600);
    const auto trusted = directory_.path() / "trusted.pem";
    for (const auto& file : {known, expired}) {
        std::ofstream(trusted, std::ios::app) << std::ifstream(file.certificate).rdbuf();
    }
    auto mutual = config();
    mutual.tls = sockets::PortTls::open({files_.certificate, files_.key, trusted}).value();
    RunningHttp server(mutual);
    using Shown = std::optional<testing_support::CertificateFiles>;
    for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
        const auto answer_to = [&](Shown shown) {
            TlsHttpClient client(server.port(),
                                 {.trusted = files_.certificate, .shown = std::move(shown), .version_max = version});
            client.send(get("/"));
            return client.read().status;
        };
        EXPECT_EQ(answer_to(known), 200);
        EXPECT_EQ(answer_to(std::nullopt), 0);
        EXPECT_EQ(answer_to(stranger), 0);
        EXPECT_EQ(answer_to(expired), 0);
    }
    server.stop();
    EXPECT_EQ(server.refusals(auth::Reason::kNoCertificate), 2.0);
    EXPECT_EQ(server.refusals(auth::Reason::kForeignCertificate), 4.0);
}

TEST_F(TlsServerTest, RefusedClientReceivesTheReason) {
    const auto known = write_certificate(directory_.path(), "known.example");
    auto mutual = config();
    mutual.tls = sockets::PortTls::open({files_.certificate, files_.key, known.certificate}).value();
    RunningHttp server(mutual);
    TlsHttpClient client(server.port(), manner());
    ASSERT_TRUE(client.is_trusted()) << "in TLS 1.3 the client finishes the handshake first";
    client.send(get("/"));
    EXPECT_EQ(client.read().status, 0);
    EXPECT_THAT(client.complaint(), HasSubstr("certificate required"));
}

TEST_F(TlsServerTest, ExcessConnectionIsClosedWithoutResponse) {
    auto small = config();
    small.connections_max = 1;
    std::promise<void> entered;
    std::promise<void> go_on;
    RunningHttp server(small, [&](const Request& request) {
        entered.set_value();
        go_on.get_future().wait();
        return echo(request);
    });
    TlsHttpClient first(server.port(), manner());
    first.send(get("/api/v1/sessions"));
    entered.get_future().wait();
    HttpClient second(server.port());
    EXPECT_TRUE(second.is_closed());
    go_on.set_value();
    EXPECT_EQ(first.read().status, 200);
}

TEST_F(TlsServerTest, ConnectionWithoutHandshakeIsReplaced) {
    auto small = config();
    small.connections_max = 1;
    RunningHttp server(small);
    HttpClient silent(server.port());
    TlsHttpClient second(server.port(), manner());
    second.send(get("/"));
    EXPECT_EQ(second.read().status, 200);
    EXPECT_TRUE(silent.is_closed());
}

} // namespace
} // namespace scanloom::http
