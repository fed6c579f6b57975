#include "common/net/tls.hpp"
#include "robot_client/uplink/recording_feed.hpp"
#include "robot_client/uplink/uplink.hpp"
#include "tests/integration/robot_client/fake_server.hpp"
#include "tests/support/recorded_source.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"

#include <boost/asio/co_spawn.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

/// Links that are encrypted, compressed, or both.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::CertificateFiles;
using testing_support::write_certificate;

std::vector<Observation> recorded_scans(std::size_t scans) {
    const auto sensor = std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 300}, 0.0, 0.0, 10.0});
    std::vector<Observation> made(scans, Observation{sensor, {}});
    for (std::size_t i = 0; i < scans; ++i) {
        made[i].scan.pose = {static_cast<double>(i + 1), 0.0, 0.0};
        for (RangeMm beam = 0; beam < 300; ++beam) made[i].scan.ranges.push_back(2000 + beam * beam % 97);
    }
    return made;
}

class LinkKinds : public testing::Test {
protected:
    /// A server on 127.0.0.1 whose certificate is for `host`, or without a certificate.
    void serve(const std::string& host, LinkScript script = {}) {
        server_.emplace(io_, std::vector{script});
        if (host.empty()) return;
        files_ = write_certificate(directory_.path(), host);
        server_->encrypt_with(net::server_tls({files_.certificate, files_.key}).value());
    }

    UplinkOptions options() {
        UplinkOptions made;
        made.servers = {{"127.0.0.1", std::to_string(server_->port())}};
        made.protocol.hello.robot = "r1";
        made.protocol.hello.session = "s1";
        made.give_up_after = 20s;
        made.on_trouble = [this](const Error& error) {
            troubles_.push_back(error.message);
            uplink_->stop(); // once is enough
        };
        return made;
    }

    Result<> run(UplinkOptions made, std::size_t scans = 200) {
        RecordedSource source(recorded_scans(scans));
        RecordingFeed feed(source, {});
        uplink_.emplace(io_, std::move(made), feed);
        Result<> outcome = Error{Errc::kTimeout, "it did not end"};
        boost::asio::co_spawn(io_, uplink_->run(), [&](std::exception_ptr failed, Result<> result) {
            EXPECT_FALSE(failed);
            outcome = std::move(result);
            io_.stop();
        });
        io_.run();
        status_ = uplink_->status();
        uplink_.reset();
        return outcome;
    }

    void expect_all_stored(std::size_t scans = 200) {
        EXPECT_THAT(server_->faults(), IsEmpty());
        ASSERT_EQ(server_->stored().size(), scans);
        for (std::size_t i = 0; i < scans; ++i) EXPECT_EQ(server_->stored()[i].pose->x, static_cast<double>(i + 1));
    }

    boost::asio::io_context io_{1};
    TemporaryDirectory directory_;
    CertificateFiles files_;
    std::optional<FakeServer> server_;
    std::optional<Uplink> uplink_;
    UplinkStatus status_;
    std::vector<std::string> troubles_;
};

TEST_F(LinkKinds, ATrustedTlsLinkCarriesEveryScan) {
    serve("127.0.0.1");
    auto made = options();
    made.tls = net::client_tls(files_.certificate).value();
    const auto outcome = run(made);
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_all_stored();
    EXPECT_EQ(server_->goodbyes(), 1);
}

TEST_F(LinkKinds, ACertificateOfAnotherHostIsRefusedBeforeTheHello) {
    serve("another.example");
    auto made = options();
    made.tls = net::client_tls(files_.certificate).value();
    EXPECT_FALSE(run(made));
    ASSERT_THAT(troubles_, testing::SizeIs(1));
    EXPECT_THAT(troubles_[0], HasSubstr("its certificate is for another name; give --server"));
    EXPECT_THAT(server_->hellos(), IsEmpty());
}

TEST_F(LinkKinds, AnUntrustedCertificateIsRefused) {
    serve("127.0.0.1");
    const auto other = write_certificate(directory_.path(), "localhost");
    auto made = options();
    made.tls = net::client_tls(other.certificate).value();
    EXPECT_FALSE(run(made));
    EXPECT_THAT(troubles_.at(0), HasSubstr("--tls-ca"));
    EXPECT_THAT(server_->hellos(), IsEmpty());
}

TEST_F(LinkKinds, AnExpiredCertificateIsReportedAsExpired) {
    serve("127.0.0.1");
    const auto expired = write_certificate(directory_.path(), "127.0.0.1", -3600);
    server_->encrypt_with(net::server_tls({expired.certificate, expired.key}).value());
    auto made = options();
    made.tls = net::client_tls(expired.certificate).value();
    EXPECT_FALSE(run(made));
    EXPECT_THAT(troubles_.at(0), HasSubstr("its certificate has expired; install a new one on the server"));
}

TEST_F(LinkKinds, AServerMayRequireAClientCertificate) {
    serve("127.0.0.1");
    const auto robot = write_certificate(directory_.path(), "localhost");
    server_->encrypt_with(net::server_tls({files_.certificate, files_.key}, robot.certificate).value());
    auto made = options();
    made.tls = net::client_tls(files_.certificate, {robot.certificate, robot.key}).value();
    const auto outcome = run(made);
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_all_stored();
}

TEST_F(LinkKinds, AMissingClientCertificateIsReportedWithAHint) {
    serve("127.0.0.1");
    const auto robot = write_certificate(directory_.path(), "localhost");
    server_->encrypt_with(net::server_tls({files_.certificate, files_.key}, robot.certificate).value());
    auto made = options();
    made.tls = net::client_tls(files_.certificate).value();
    EXPECT_FALSE(run(made));
    EXPECT_THAT(troubles_.at(0), HasSubstr("name yours with --tls-cert and --tls-key"));
    EXPECT_THAT(server_->hellos(), IsEmpty());
}

TEST_F(LinkKinds, TlsOnOneSideOnlyIsReportedWithAHint) {
    serve("127.0.0.1");
    EXPECT_FALSE(run(options()));
    EXPECT_THAT(troubles_.at(0), HasSubstr("add --tls"));
    const auto trusted = files_.certificate;
    server_.reset();
    io_.restart();
    serve("");
    auto made = options();
    made.tls = net::client_tls(trusted).value();
    EXPECT_FALSE(run(made));
    EXPECT_THAT(troubles_.at(1), HasSubstr("leave --tls out"));
}

TEST_F(LinkKinds, InvalidCertificateFilesAreNamed) {
    serve("127.0.0.1");
    EXPECT_THAT(net::client_tls(files_.key).error().message, HasSubstr("127.0.0.1.key: no certificate"));
    EXPECT_THAT(net::client_tls("/nowhere").error().message, HasSubstr("/nowhere"));
    EXPECT_THAT(net::server_tls({files_.key, files_.key}).error().message, HasSubstr("no certificate"));
    EXPECT_THAT(net::server_tls({files_.certificate, files_.certificate}).error().message, HasSubstr("no private key"));
    EXPECT_THAT(net::client_tls(files_.certificate, {files_.certificate}).error().message, HasSubstr("no private key"));
    const auto both = directory_.path() / "both.pem";
    for (const auto& file : {files_.certificate, files_.key}) {
        std::ofstream(both, std::ios::app) << std::ifstream(file).rdbuf();
    }
    EXPECT_TRUE(net::client_tls(files_.certificate, {both})) << "the key is in the same file";
    EXPECT_THAT(net::server_tls({files_.certificate, files_.key}, files_.key).error().message,
                HasSubstr("127.0.0.1.key: no certificate"));
    const auto other = write_certificate(directory_.path(), "localhost");
    EXPECT_EQ(net::server_tls({files_.certificate, other.key}).error().code, Errc::kConflict);
}

TEST_F(LinkKinds, AServerKeyWithLoosePermissionsIsRefused) {
    using std::filesystem::perms;
    serve("127.0.0.1");
    const auto read_with = [&](unsigned mode) {
        std::filesystem::permissions(files_.key, perms{mode});
        return net::server_tls({files_.certificate, files_.key});
    };
    for (const unsigned mode : {0400U, 0600U, 0440U, 0640U, 0700U, 0750U}) {
        EXPECT_TRUE(read_with(mode)) << std::oct << mode;
    }
    for (const unsigned mode : {0644U, 0444U, 0604U, 0602U, 0620U, 0660U, 0601U}) {
        const auto refused = read_with(mode);
        ASSERT_FALSE(refused) << std::oct << mode;
        EXPECT_EQ(refused.error().code, Errc::kInvalidField) << std::oct << mode;
        EXPECT_THAT(refused.error().message, HasSubstr("chmod g-w,o= " + files_.key.string()));
    }
    const auto both = directory_.path() / "both.pem"; // of the modes that the system gives
    for (const auto& file : {files_.certificate, files_.key}) {
        std::ofstream(both, std::ios::app) << std::ifstream(file).rdbuf();
    }
    std::filesystem::permissions(both, perms{0644U});
    EXPECT_FALSE(net::server_tls({both})) << "the key is in the same file";
    std::filesystem::permissions(both, perms{0600U});
    EXPECT_TRUE(net::server_tls({both}));
}

TEST_F(LinkKinds, CompressionSendsFewerBytesAndTheSameScans) {
    serve("", {.zstd = true});
    auto made = options();
    EXPECT_TRUE(run(made));
    const auto plain_bytes = status_.bytes;
    EXPECT_EQ(server_->compressed_batches(), 0U);
    expect_all_stored();
    server_.reset();
    io_.restart();
    serve("", {.zstd = true});
    made = options();
    made.protocol.compress = true;
    EXPECT_TRUE(run(made));
    expect_all_stored();
    EXPECT_EQ(server_->compressed_batches(), server_->batches());
    EXPECT_LT(3 * status_.bytes, plain_bytes);
}

TEST_F(LinkKinds, AServerWithoutCompressionGetsPlainScans) {
    serve("", {.zstd = false});
    auto made = options();
    made.protocol.compress = true;
    EXPECT_TRUE(run(made));
    expect_all_stored();
    EXPECT_EQ(server_->compressed_batches(), 0U);
}

} // namespace
} // namespace scanloom::robot
