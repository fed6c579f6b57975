#include "tests/integration/ingest_fixture.hpp"
#include "tests/support/captured_log.hpp"
#include "tests/support/http_client.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"
#include "tests/support/tls_http_client.hpp"

#include <boost/asio/post.hpp>

#include <atomic>
#include <future>
#include <latch>

/// Links that the server ends: deadlines, limits, a failing disk, deletion, shutdown.
namespace scanloom::ingest {
namespace {

using namespace std::chrono_literals;
using testing_support::CapturedLog;

/// Long enough for a TLS handshake on a busy machine.
constexpr auto kHandshakeTime = 500ms;

TEST_F(IngestTest, AMissingHelloIsReportedToTheRobot) {
    IngestConfig config;
    config.link.hello_deadline = 10ms;
    start(config);
    RobotSocket silent(port());
    expect_refused(silent, Errc::kTimeout, true, "no hello was received in time");
    RobotSocket slow(port());
    slow.send_bytes(frame_of(hello("r")).substr(0, 10));
    expect_refused(slow, Errc::kTimeout, true, "no hello was received in time");
}

/// No error can be sent before the handshake.
TEST_F(IngestTest, AnUnfinishedTlsHandshakeIsClosedAndBlocksNoOtherLink) {
    const TemporaryDirectory directory;
    const auto files = testing_support::write_certificate(directory.path(), "127.0.0.1");
    IngestConfig config;
    config.tls = sockets::PortTls::open({files.certificate, files.key, {}}).value();
    config.link.hello_deadline = kHandshakeTime;
    config.link.farewell_deadline = 50ms;
    start(config);
    RobotSocket silent(port());
    RobotSocket slow(port());
    slow.send_bytes(std::string_view("\x16\x03\x01\x02\x00\x01", 6));
    const testing_support::TlsHttpClient quick(port(), {.trusted = files.certificate});
    EXPECT_TRUE(quick.is_trusted());
    EXPECT_FALSE(silent.receive());
    EXPECT_FALSE(slow.receive());
}

/// A finished handshake does not replace the hello.
TEST_F(IngestTest, AMissingHelloIsReportedOverTls) {
    const TemporaryDirectory directory;
    const auto files = testing_support::write_certificate(directory.path(), "127.0.0.1");
    IngestConfig config;
    config.tls = sockets::PortTls::open({files.certificate, files.key, {}}).value();
    config.link.hello_deadline = kHandshakeTime;
    start(config);
    testing_support::TlsHttpClient robot(port(), {.trusted = files.certificate});
    ASSERT_TRUE(robot.is_trusted());
    EXPECT_THAT(robot.read_all(), testing::HasSubstr("no hello was received in time"));
}

TEST_F(IngestTest, ASilentRobotGetsATimeoutError) {
    IngestConfig config;
    config.link.idle_deadline = 10ms;
    start(config);
    const auto robot = welcomed(port(), hello("r"));
    expect_refused(*robot, Errc::kTimeout, true, "nothing was received for too long");
}

TEST_F(IngestTest, ARobotThatDoesNotCloseIsDisconnected) {
    IngestConfig config;
    config.link.farewell_deadline = 10ms;
    start(config);
    RobotSocket robot(port());
    robot.send(wire::Ping{});
    expect_refused(robot, Errc::kMalformed, false, "the first frame is a ping");
    EXPECT_THROW(for (;;) robot.send_bytes(std::string(65'536, 'x')), boost::system::system_error)
        << "the robot reads no more";
}

TEST_F(IngestTest, RobotsBeyondTheLimitGetARetryableError) {
    IngestConfig config;
    config.links_max = 1;
    start(config);
    auto first = welcomed(port(), hello("r1"));
    {
        RobotSocket second(port());
        second.send(hello("r2"));
        expect_refused(second, Errc::kOverloaded, true, "1 robots are connected, the most this server takes");
    }
    first.reset();
    for (;;) { // until the server notices that the first link has ended
        RobotSocket second(port());
        second.send(hello("r2"));
        const auto answer = second.receive().value();
        if (std::holds_alternative<wire::Welcome>(answer)) break;
        ASSERT_TRUE(std::holds_alternative<wire::LinkError>(answer));
    }
}

TEST_F(IngestTest, SilentConnectionsDoNotBlockRobots) {
    IngestConfig config;
    config.links_max = 2;
    config.greeting_max = 3;
    config.link.hello_deadline = 1h;
    start(config);
    std::vector<std::unique_ptr<RobotSocket>> silent;
    for (int n = 0; n < 10; ++n) silent.push_back(std::make_unique<RobotSocket>(port()));
    const auto first = welcomed(port(), hello("r1"));
    for (int n = 0; n < 8; ++n) EXPECT_FALSE(silent[n]->receive()) << "the oldest were closed";
    const auto second = welcomed(port(), hello("r2"));
    RobotSocket third(port());
    expect_refused(third, Errc::kOverloaded, true, "2 robots are connected");
    silent.clear();
}

/// A log that creates no session before the authenticator is open.
class GatedLog final : public store::MemoryScanLog {
public:
    [[nodiscard]] Result<store::SessionId> create_session(std::string_view record) override {
        reached_.count_down();
        open_.wait();
        return MemoryScanLog::create_session(record);
    }
    void wait_until_reached() { reached_.wait(); }
    void open() { opener_.set_value(); }

private:
    std::latch reached_{1};
    std::promise<void> opener_;
    std::shared_future<void> open_ = opener_.get_future().share();
};

TEST(Ingest, CreatingSessionsDoesNotBlockOtherChanges) {
    GatedLog log;
    RunningIngest ingest(log);
    std::vector<std::unique_ptr<RobotSocket>> robots;
    for (int n = 0; n < 8; ++n) {
        robots.push_back(std::make_unique<RobotSocket>(ingest.port()));
        robots.back()->send(hello("r" + std::to_string(n), "same"));
    }
    log.wait_until_reached();
    for (int n = 0; n < 1000; ++n) { // meanwhile the other hellos arrive
        const auto changed = std::make_shared<std::promise<void>>();
        boost::asio::post(ingest.blocking_executor(), [changed] { changed->set_value(); });
        changed->get_future().wait(); // would wait forever if robots held every thread
    }
    log.open();
    for (const auto& robot : robots) robot->receive_kind<wire::Welcome>();
    EXPECT_EQ(ingest.sessions().list().size(), 1U);
}

TEST_F(IngestTest, AnHttpRequestIsReferredToTheHttpPort) {
    start();
    testing_support::HttpClient browser(port());
    browser.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto answer = browser.read();
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, testing::HasSubstr("browsers to the HTTP port"));
    EXPECT_TRUE(browser.ends_in_order());
}

TEST_F(IngestTest, TheLogDistinguishesRobotsFromConnectionsWithoutAHello) {
    CapturedLog log;
    start();
    {
        testing_support::HttpClient browser(port());
        browser.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_EQ(browser.read().status, 400);
        const auto robot = welcomed(port(), hello("r7"));
        robot->send(wire::Goodbye{});
        EXPECT_FALSE(robot->receive());
    }
    running_.reset();
    EXPECT_THAT(log.text(), testing::HasSubstr("a link from 127.0.0.1:"));
    EXPECT_THAT(log.text(), testing::HasSubstr(" without a valid hello ended: the data begins with \"GET \""));
    EXPECT_THAT(log.text(), testing::ContainsRegex("robot 'r7' at 127.0.0.1:[0-9]+ left: goodbye"));
    EXPECT_THAT(log.text(), testing::Not(testing::HasSubstr("robot ''")));
}

TEST_F(IngestTest, ConnectionsWithoutAHelloDoNotFillTheLog) {
    constexpr int kStrangers = 300;
    CapturedLog log;
    start();
    const auto begin = std::chrono::steady_clock::now();
    for (int n = 0; n < kStrangers; ++n) {
        testing_support::HttpClient stranger(port());
        stranger.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_EQ(stranger.read().status, 400);
    }
    running_.reset();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = log.text().find("without a valid hello", at)) != std::string::npos; ++at) ++lines;
    EXPECT_GE(lines, 1U);
    EXPECT_LE(lines, static_cast<std::size_t>(took.count()) + 1);
}

TEST_F(IngestTest, PingsWithUnreadPongsAreLimited) {
    start();
    const auto robot = welcomed(port(), hello("r"));
    std::string pings;
    for (std::uint64_t n = 0; n < 50'000; ++n) pings += frame_of(wire::Ping{n});
    std::atomic<bool> ended = false;
    std::thread sending([&] {
        while (!ended) robot->send_bytes(pings);
    });
    std::optional<wire::LinkError> refused; // reading starts when the server's limit is almost reached
    while (running_->sessions().find("lab")->is_connected(0)) std::this_thread::yield();
    while (const auto message = robot->receive()) {
        if (const auto* error = std::get_if<wire::LinkError>(&*message)) refused = *error;
        if (refused) ended = true;
    }
    sending.join();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->error.code, Errc::kCreditExceeded);
    EXPECT_FALSE(refused->retryable);
    EXPECT_THAT(refused->error.message,
                testing::HasSubstr("bytes of pongs and refusals wait to be read, at most 65536 may"));
}

TEST_F(IngestTest, AFullSessionIsAFinalError) {
    start();
    struct Silent : sessions::RobotListener {
        void on_durable(std::uint64_t, std::size_t) override {}
        void on_failed(const Error&) override {}
    };
    const auto robot = welcomed(port(), hello("r"));
    const auto session = running_->sessions().find("lab");
    for (int n = 1; n < 1024; ++n) {
        session->join({"r" + std::to_string(n)}, std::make_shared<Silent>(), [](const Result<sessions::Joined>&) {});
    }
    RobotSocket last(port());
    last.send(hello("last"));
    expect_refused(last, Errc::kFull, false, "session 'lab' has 1024 robots already");
    welcomed(port(), hello("r"));
}

TEST_F(IngestTest, AFailedDiskIsARetryableError) {
    start();
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    stream(*robot, 1, 1, 10);
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    robot->send(wire::ScanBatch{random_scans(1, 11, 1)});
    expect_refused(*robot, Errc::kStoreFailed, true, "no space left");
    RobotSocket again(port());
    again.send(hello("r"));
    expect_refused(again, Errc::kStoreFailed, true, "no space left");
    RobotSocket elsewhere(port());
    elsewhere.send(hello("r", "another"));
    expect_refused(elsewhere, Errc::kStoreFailed, true, "no space left");
}

TEST_F(IngestTest, DeletingASessionEndsItsLinksWithAnError) {
    auto& ingest = start();
    const auto robot = welcomed(port(), hello("r"));
    const auto other = welcomed(port(), hello("r", "other"));
    robot->send(small_laser());
    ASSERT_TRUE(ingest.sessions().remove("lab"));
    expect_refused(*robot, Errc::kGone, false, "session 'lab' was deleted");
    other->send(small_laser());
    stream(*other, 1, 1, 10);
}

TEST_F(IngestTest, StoppingAcknowledgesEveryReceivedScanFirst) {
    auto& ingest = start();
    std::vector<std::unique_ptr<RobotSocket>> robots;
    for (int n = 0; n < 4; ++n) {
        robots.push_back(welcomed(port(), hello("r" + std::to_string(n), "s" + std::to_string(n % 2))));
        robots.back()->send(small_laser());
        stream(*robots.back(), 1, 1, 10);
    }
    log_.hold_completions();
    for (auto& robot : robots) {
        robot->send(wire::ScanBatch{random_scans(1, 11, 20)});
        robot->send(wire::Ping{1});
        robot->receive_kind<wire::Pong>(); // the batch has been handed to the session
    }
    ingest.stop_accepting();
    std::thread draining([&] { ingest.sessions().drain(); });
    while (!ingest.sessions().is_draining()) std::this_thread::yield();
    log_.release_completions();
    for (auto& robot : robots) {
        robot->wait_for_ack(30);
        expect_refused(*robot, Errc::kShuttingDown, true, "the server is shutting down");
    }
    draining.join();
    EXPECT_THROW(for (;;) RobotSocket{port()}, boost::system::system_error) << "the port must be closed";
}

TEST_F(IngestTest, StoppingDuringStreamsLosesNoAcknowledgedScan) {
    std::vector<std::uint64_t> acknowledged(4, 0);
    {
        auto& ingest = start();
        std::atomic<int> streaming = 0;
        std::vector<std::thread> robots;
        for (unsigned n = 0; n < acknowledged.size(); ++n) {
            robots.emplace_back([&, n] {
                const auto robot = welcomed(port(), hello("r" + std::to_string(n)));
                robot->send(small_laser());
                for (std::uint64_t seq = 1;; ++seq) {
                    robot->send(wire::ScanBatch{{random_scan(n, seq)}});
                    for (;;) {
                        const auto message = robot->receive().value();
                        if (const auto* error = std::get_if<wire::LinkError>(&message)) {
                            EXPECT_EQ(error->error.code, Errc::kShuttingDown);
                            return;
                        }
                        acknowledged[n] = std::get<wire::Ack>(message).durable_seq;
                        if (acknowledged[n] == seq) break;
                    }
                    if (seq == 20) ++streaming;
                }
            });
        }
        while (streaming < 4) std::this_thread::yield();
        ingest.stop_accepting();
        ingest.sessions().drain();
        for (auto& robot : robots) robot.join();
        running_.reset();
    }
    start();
    for (std::size_t n = 0; n < acknowledged.size(); ++n) {
        RobotSocket robot(port());
        robot.send(hello("r" + std::to_string(n)));
        EXPECT_GE(robot.receive_kind<wire::Welcome>().last_durable_seq, acknowledged[n]);
    }
}

} // namespace
} // namespace scanloom::ingest
