#include "tests/support/http_client.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"
#include "tests/support/tls_http_client.hpp"

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

namespace scanloom::test {
namespace {

using testing::HasSubstr;
using testing_support::TlsHttpClient;
using testing_support::TlsManner;
using testing_support::write_certificate;

/// A server whose HTTP port has a certificate, started as users do.
class CertificatesTest : public testing::Test {
protected:
    void start(std::vector<std::string> more = {}) {
        more.insert(more.end(),
                    {"--http-tls-cert", files_.certificate.string(), "--http-tls-key", files_.key.string()});
        server_ = std::make_unique<RunningServer>(place_.path() / "store", log_, 0, 0, more);
    }

    [[nodiscard]] std::string log() const {
        std::ifstream file(log_);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    void wait_for_log(const std::string& text) const {
        while (log().find(text) == std::string::npos) std::this_thread::yield();
    }

    [[nodiscard]] testing_support::HttpAnswer ask(const std::string& request) const {
        TlsHttpClient client(server_->http_port(), {.trusted = files_.certificate});
        client.send(request);
        return client.read();
    }

    TemporaryDirectory place_;
    std::filesystem::path log_ = place_.path() / "log";
    testing_support::CertificateFiles files_ = write_certificate(place_.path(), "127.0.0.1");
    std::unique_ptr<RunningServer> server_;
};

TEST_F(CertificatesTest, BrowsersMustUseTls) {
    const auto tokens = place_.path() / "tokens.toml";
    ChildProcess maker(program("scanloom-server"), {"token", "--name", "v", "--role", "viewer"},
                       place_.path() / "maker");
    const auto secret = maker.read_line().value();
    {
        std::ofstream file(tokens);
        while (const auto line = maker.read_line()) file << *line << "\n";
    }
    ASSERT_EQ(maker.wait(), 0);
    start({"--tokens", tokens.string()});
    const auto page = ask("GET / HTTP/1.1\r\nHost: localhost:8443\r\n\r\n");
    EXPECT_EQ(page.fields.at("strict-transport-security"), "max-age=31536000");
    const auto body = fmt::format(R"({{"token":"{}"}})", secret);
    const auto login = ask(fmt::format("POST /api/v1/login HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
                                       "application/json\r\nContent-Length: {}\r\n\r\n{}",
                                       body.size(), body));
    EXPECT_EQ(login.status, 200) << login.body;
    EXPECT_THAT(login.fields.at("set-cookie"), HasSubstr("; Secure"));
    EXPECT_THAT(log(), HasSubstr("browsers: https://"));
}

TEST_F(CertificatesTest, AreReloadedOnSighupUnlessAFileIsInvalid) {
    start();
    const auto old = place_.path() / "old.crt";
    std::filesystem::copy_file(files_.certificate, old);
    std::filesystem::resize_file(files_.certificate, 100);
    server_->process().signal(SIGHUP);
    wait_for_log("the previous certificate stays in force");
    EXPECT_THAT(log(), HasSubstr("--http-tls-cert: " + files_.certificate.string()));
    EXPECT_TRUE(TlsHttpClient(server_->http_port(), {.trusted = old}).is_trusted());

    files_ = write_certificate(place_.path(), "127.0.0.1");
    server_->process().signal(SIGHUP);
    wait_for_log("--http-tls-cert: read again from");
    EXPECT_TRUE(TlsHttpClient(server_->http_port(), {.trusted = files_.certificate}).is_trusted());
    EXPECT_FALSE(TlsHttpClient(server_->http_port(), {.trusted = old}).is_trusted());
}

TEST_F(CertificatesTest, WithoutThemSighupIsIgnored) {
    RunningServer server(place_.path() / "store", log_);
    server.process().signal(SIGHUP);
    wait_for_log("neither tokens nor certificates");
    EXPECT_EQ(server.get("/livez").status, 200U);
}

TEST_F(CertificatesTest, OfClientsAreRequiredOnBothPortsIfAClientCaIsSet) {
    const auto robot = write_certificate(place_.path(), "robot.example");
    const auto ca = robot.certificate.string();
    start({"--http-client-ca", ca, "--robot-tls-cert", files_.certificate.string(), "--robot-tls-key",
           files_.key.string(), "--robot-client-ca", ca});
    for (const auto port : {server_->http_port(), server_->robot_port()}) {
        TlsHttpClient stranger(port, {.trusted = files_.certificate});
        EXPECT_EQ(stranger.read().status, 0);
        EXPECT_THAT(stranger.complaint(), HasSubstr("certificate required"));
        TlsHttpClient foreigner(port, {.trusted = files_.certificate, .shown = files_});
        EXPECT_EQ(foreigner.read().status, 0);
        EXPECT_THAT(foreigner.complaint(), HasSubstr("alert unknown ca"));
    }
    for (const auto* port : {"http", "robot"}) {
        wait_for_log(fmt::format("port={} who=127.0.0.1 token=- reason=no_certificate", port));
        wait_for_log(fmt::format("port={} who=127.0.0.1 token=- reason=foreign_certificate", port));
    }
    ChildProcess known(program("scanloom-robot"),
                       {"--server", server_->robot_address(), "--session", "s", "--robot", "r", "--tls-ca",
                        files_.certificate.string(), "--tls-cert", ca, "--tls-key", robot.key.string(), "simulate",
                        "--speed", "0", "--scans", "20"},
                       place_.path() / "robot");
    static_cast<void>(known.read_line());
    EXPECT_EQ(known.wait(), 0);
    TlsHttpClient reader(server_->http_port(), {.trusted = files_.certificate, .shown = robot});
    reader.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto metrics = reader.read().body;
    EXPECT_THAT(metrics, HasSubstr("scanloom_refusals_total{port=\"robot\",reason=\"no_certificate\"} 1"));
    EXPECT_THAT(metrics, HasSubstr("scanloom_refusals_total{port=\"http\",reason=\"foreign_certificate\"} 1"));
}

TEST_F(CertificatesTest, ThatCannotBeReadPreventTheStart) {
    const auto missing = (place_.path() / "missing.pem").string();
    ChildProcess server(program("scanloom-server"),
                        {"--store", (place_.path() / "store").string(), "--listen", "127.0.0.1:0", "--http",
                         "127.0.0.1:0", "--http-tls-cert", missing, "--http-tls-key", missing},
                        log_);
    EXPECT_FALSE(server.read_line());
    EXPECT_EQ(server.wait(), 1);
    EXPECT_THAT(log(), HasSubstr("--http-tls-cert: " + missing));
}

TEST_F(CertificatesTest, AKeyReadableByOthersIsRefusedAtStartAndOnSighup) {
    using std::filesystem::perms;
    start();
    std::filesystem::permissions(files_.key, perms::others_read, std::filesystem::perm_options::add);
    server_->process().signal(SIGHUP);
    wait_for_log("--http-tls-cert: "); // the result of the reload
    EXPECT_THAT(log(), HasSubstr("chmod g-w,o= " + files_.key.string()));
    EXPECT_TRUE(TlsHttpClient(server_->http_port(), {.trusted = files_.certificate}).is_trusted());

    ChildProcess other(program("scanloom-server"),
                       {"--store", (place_.path() / "other").string(), "--listen", "127.0.0.1:0", "--http",
                        "127.0.0.1:0", "--http-tls-cert", files_.certificate.string(), "--http-tls-key",
                        files_.key.string()},
                       log_);
    ASSERT_FALSE(other.read_line());
    EXPECT_EQ(other.wait(), 1);
}

} // namespace
} // namespace scanloom::test
