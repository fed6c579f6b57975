#include "robot_client/sources/source.hpp"
#include "tests/integration/robot_client/client_fixture.hpp"

#include <csignal>

/// The library that a robot's own program links, with a real server.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ClientTest : public ClientFixture {};

TEST_F(ClientTest, FlushedScansAreStored) {
    serve();
    const auto client = Client::start(options()).value();
    send(*client, 1, 300);
    const auto flushed = client->flush(20s);
    ASSERT_TRUE(flushed) << flushed.error().message;
    const auto status = client->status();
    EXPECT_EQ(status.acknowledged, 300U);
    EXPECT_EQ(status.waiting, 0U);
    EXPECT_TRUE(status.is_linked);
    send(*client, 301, 310);
    EXPECT_TRUE(client->close(20s));
    EXPECT_EQ(client->send(laser(), numbered(311)).error().code, Errc::kGone);
    EXPECT_EQ(client->status().acknowledged, 310U);
    const auto map = server_->get("/api/v1/sessions/lab/map.csv?layer=occupancy");
    EXPECT_EQ(map.status, 200U);
}

TEST_F(ClientTest, ASecondProgramContinuesAfterTheFirst) {
    serve();
    for (int round = 0; round < 3; ++round) {
        const auto client = Client::start(options()).value();
        send(*client, 1 + 50 * round, 50 + 50 * round);
        ASSERT_TRUE(client->close(20s));
        EXPECT_EQ(client->status().acknowledged, static_cast<std::uint64_t>(50 + 50 * round));
    }
    const auto other = Client::start(options("undisturbed")).value();
    send(*other, 1, 150);
    ASSERT_TRUE(other->close(20s));
    EXPECT_EQ(digest_of("lab"), digest_of("undisturbed"));
}

TEST_F(ClientTest, AKilledServerLosesNoScanOfTheClient) {
    serve();
    const auto port = server_->robot_port();
    const auto client = Client::start(options()).value();
    send(*client, 1, 200);
    server_->process().signal(SIGKILL);
    server_->process().wait();
    send(*client, 201, 400);
    serve(port);
    const auto closed = client->close(30s);
    ASSERT_TRUE(closed) << closed.error().message;
    const auto other = Client::start(options("undisturbed")).value();
    send(*other, 1, 400);
    ASSERT_TRUE(other->close(20s));
    EXPECT_EQ(digest_of("lab"), digest_of("undisturbed"));
}

TEST_F(ClientTest, TheNextProgramSendsTheSpool) {
    auto made = options();
    made.server = "127.0.0.1:1"; // no server listens there
    made.spool = directory_.path() / "spool";
    {
        const auto client = Client::start(made).value();
        send(*client, 1, 80);
        EXPECT_EQ(client->flush(50ms).error().code, Errc::kTimeout);
        EXPECT_EQ(client->status().waiting, 80U);
    }
    serve();
    made.server = server_->robot_address();
    const auto client = Client::start(made).value();
    send(*client, 81, 100);
    ASSERT_TRUE(client->close(20s));
    EXPECT_EQ(client->status().acknowledged, 100U);
}

TEST_F(ClientTest, InvalidScansAreRefusedImmediately) {
    const auto client = Client::start(options()).value();
    const auto refusal = [&](auto&& change, const std::shared_ptr<const Sensor>& sensor) {
        Scan scan = numbered(1);
        change(scan);
        const auto sent = client->send(sensor, std::move(scan));
        return sent ? std::string("taken") : sent.error().message;
    };
    EXPECT_THAT(refusal([](Scan& scan) { scan.pose->x = std::numeric_limits<double>::quiet_NaN(); }, laser()),
                HasSubstr("pose.x is nan"));
    EXPECT_THAT(refusal([](Scan& scan) { scan.ranges.clear(); }, laser()), HasSubstr("ranges is empty"));
    EXPECT_THAT(refusal([](Scan& scan) { scan.sensor = 3; }, laser()), HasSubstr("of sensor 3, the sensor given is 0"));
    EXPECT_THAT(refusal([](Scan& scan) { scan.ranges.resize(4097); }, laser()), HasSubstr("4097 beams"));
    EXPECT_THAT(refusal([](Scan&) {}, nullptr), HasSubstr("needs its sensor"));
    Sensor unreadable = *laser();
    unreadable.name = "la\xffser";
    EXPECT_THAT(refusal([](Scan&) {}, std::make_shared<const Sensor>(unreadable)),
                HasSubstr("name 'la\\xffser' is not UTF-8"));
    EXPECT_THAT(refusal([](Scan& scan) { scan.ranges.resize(1'000'000); }, laser()), HasSubstr("1000000 beams"));
    Sensor without_range = *laser();
    without_range.range_max = 0.0;
    EXPECT_THAT(refusal([](Scan&) {}, std::make_shared<const Sensor>(without_range)), HasSubstr("range_max"));
    Sensor far_sighted = *laser();
    far_sighted.range_max = 900.0; // the cells are of 0.1 m
    EXPECT_THAT(refusal([](Scan&) {}, std::make_shared<const Sensor>(far_sighted)),
                HasSubstr("range_max is 900 m, more than 8192 cells"));
    EXPECT_EQ(refusal([](Scan&) {}, laser()), "taken");
}

TEST_F(ClientTest, HelloAndScansHaveThePosesOfTheClient) {
    for (const Poses poses : {Poses::kMap, Poses::kOdometry, Poses::kNone}) {
        ServerInTheTest server;
        server.run();
        auto made = options();
        made.server = server.address();
        made.poses = poses;
        const auto client = Client::start(made).value();
        Scan scan = numbered(1);
        scan.pose.reset();
        set_pose(scan, poses, {1.0, 2.0, 0.5});
        ASSERT_TRUE(client->send(laser(), scan));
        scan.pose = poses == Poses::kMap ? std::nullopt : std::optional(Pose2{});
        EXPECT_EQ(client->send(laser(), scan).error().code, Errc::kInvalidField);
        ASSERT_TRUE(client->close(20s));
        EXPECT_EQ(server.fake().hellos().back().poses, poses);
        ASSERT_EQ(server.fake().stored().size(), 1U);
        EXPECT_TRUE(agrees_with(server.fake().stored()[0], poses));
    }
}

TEST_F(ClientTest, InvalidOptionsAreRefusedAtTheStart) {
    const auto refusal = [&](auto&& change) {
        auto made = options();
        change(made);
        const auto started = Client::start(std::move(made));
        return started ? std::string("started") : started.error().message;
    };
    EXPECT_THAT(refusal([](auto& made) { made.server = "here"; }), HasSubstr("'here' is not HOST:PORT"));
    EXPECT_THAT(refusal([](auto& made) { made.session = "a/b"; }), HasSubstr("'a/b' is no name"));
    EXPECT_THAT(refusal([](auto& made) { made.robot = ""; }), HasSubstr("'' is no name"));
    EXPECT_THAT(refusal([](auto& made) { made.body_radius = -1.0; }), HasSubstr("body_radius"));
    EXPECT_THAT(refusal([](auto& made) { made.tls_ca_file = "/nowhere"; }), HasSubstr("/nowhere"));
    EXPECT_THAT(refusal([](auto& made) { made.tls_cert_file = "/missing"; }), HasSubstr("/missing"));
    EXPECT_THAT(refusal([](auto& made) { made.spool = "/proc/spool"; }), HasSubstr("/proc/spool"));
    EXPECT_THAT(refusal([](auto& made) { made.cell_size = 0.0; }), HasSubstr("a cell_size of 0 m cannot be"));
    EXPECT_THAT(refusal([](auto& made) { made.memory_bytes_max = 0; }), HasSubstr("memory_bytes_max of 0 MiB"));
    EXPECT_THAT(refusal([](auto& made) { made.spool_bytes_max = 1000; }), HasSubstr("spool_bytes_max of"));
    EXPECT_THAT(refusal([](auto& made) { made.batch_delay = -1ms; }), HasSubstr("batch_delay of -0.001 s"));
    EXPECT_THAT(refusal([](auto& made) { made.batch_delay = 61s; }), HasSubstr("batch_delay of 61 s"));
    EXPECT_THAT(refusal([](auto& made) { made.token = std::string(20'000, 't'); }), HasSubstr("token has 20000 bytes"));
    EXPECT_THAT(refusal([](auto& made) { made.token = "\xff"; }), HasSubstr("not UTF-8"));
    EXPECT_EQ(refusal([](auto&) {}), "started");
}

TEST_F(ClientTest, AFinalErrorEndsTheClientWithTheServersMessage) {
    serve();
    const auto first = Client::start(options()).value();
    send(*first, 1, 1);
    ASSERT_TRUE(first->flush(20s));
    auto made = options();
    made.cell_size = 0.2; // the session has another cell size
    const auto second = Client::start(made).value();
    if (const auto sent = second->send(laser(), numbered(1))) { // otherwise the server has already refused the link
        const auto flushed = second->flush(20s);
        ASSERT_FALSE(flushed);
        EXPECT_EQ(flushed.error().code, Errc::kConflict);
    }
    EXPECT_EQ(second->send(laser(), numbered(2)).error().code, Errc::kConflict);
}

TEST_F(ClientTest, AFlushDoesNotWaitForLaterScans) {
    ServerInTheTest server; // its credit is a few scans, so that the client never catches up
    server.run();
    auto made = options();
    made.server = server.address();
    const auto client = Client::start(made).value();
    send(*client, 1, 200);
    std::jthread other([&client](const std::stop_token& stop) {
        for (int number = 101; !stop.stop_requested(); ++number) {
            while (client->status().waiting > 200 && !stop.stop_requested()) std::this_thread::yield();
            if (!client->send(laser(), numbered(number))) return; // the client is closed
        }
    });
    for (int round = 0; round < 5; ++round) {
        const auto flushed = client->flush(20s);
        ASSERT_TRUE(flushed) << flushed.error().message;
    }
    const auto closed = client->close(20s);
    EXPECT_TRUE(closed) << closed.error().message;
}

TEST_F(ClientTest, TheNextFlushReportsDroppedScans) {
    ServerInTheTest server;
    auto made = options();
    made.server = server.address();
    made.memory_bytes_max = 200'000;
    const auto client = Client::start(made).value();
    send(*client, 1, 600);
    EXPECT_EQ(client->flush(1ms).error().code, Errc::kTimeout);
    server.run();
    const auto flushed = client->flush(20s);
    ASSERT_FALSE(flushed);
    EXPECT_EQ(flushed.error().code, Errc::kOverloaded);
    const auto dropped = client->status().dropped;
    EXPECT_GT(dropped, 100U);
    EXPECT_THAT(flushed.error().message, HasSubstr(fmt::format("{} scans were dropped", dropped)));
    EXPECT_EQ(client->status().acknowledged, 600U - dropped);
    send(*client, 601, 610);
    const auto again = client->flush(20s);
    EXPECT_TRUE(again) << again.error().message;
    EXPECT_TRUE(client->close(20s));
}

TEST_F(ClientTest, ManyThreadsMaySend) {
    serve();
    const auto client = Client::start(options()).value();
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 4; ++thread) {
        threads.emplace_back([&client, thread] { send(*client, 1 + 100 * thread, 100 + 100 * thread); });
    }
    threads.clear();
    ASSERT_TRUE(client->close(20s));
    EXPECT_EQ(client->status().acknowledged, 400U);
}

} // namespace
} // namespace scanloom::robot
