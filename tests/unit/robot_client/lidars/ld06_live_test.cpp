#include "tests/unit/robot_client/lidars/ld06_live_fixture.hpp"

#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

namespace scanloom::robot {
namespace {

using asio::ip::tcp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Ld06Lives, SerialDeviceGivesACompleteTurn) {
    const PseudoTerminal sensor;
    LidarLive source(options(SerialDevice{sensor.device()}));
    const Scan scan = scan_of(source, [&] { sensor.send(one_turn()); });
    EXPECT_EQ(scan.ranges.size(), 450U);
    EXPECT_EQ(scan.ranges.back(), 1000U);
    EXPECT_EQ(scan.pose, (Pose2{1.0, 2.0, 0.5}));
    EXPECT_NEAR(scan.stamp, unix_now(), 60.0) << "stamps are Unix time";
    EXPECT_EQ(source.remarks(), "0 damaged packets, 1 turn");
    EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(Ld06Lives, DeviceWithoutPosesGivesScansWithoutPoses) {
    const PseudoTerminal sensor;
    auto made = options(SerialDevice{sensor.device()}, Pose2{});
    made.kind = Poses::kNone;
    LidarLive source(std::move(made));
    const Scan scan = scan_of(source, [&] { sensor.send(one_turn()); });
    EXPECT_EQ(scan.ranges.size(), 450U);
    EXPECT_FALSE(scan.pose || scan.odometry);
}

TEST_F(Ld06Lives, SerialDeviceTransfersEveryByteValue) {
    const PseudoTerminal sensor; // a line that is not in raw mode would change or drop some of these bytes
    LidarLive source(options(SerialDevice{sensor.device()}));
    Bytes every(256);
    for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<std::uint8_t>(i);
    (void)scan_of(source, [&] {
        sensor.send(every);
        Ld06Spinner spinner(35'000);
        for (int i = 0; i < 40; ++i) {
            auto packet = spinner.next();
            for (auto& point : packet.points) point.distance = static_cast<std::uint16_t>(0x0A0D + 0x0102 * i);
            sensor.send(testing_support::bytes_of(packet));
        }
    });
    EXPECT_EQ(source.remarks(), "0 damaged packets, 1 turn");
}

TEST_F(Ld06Lives, MissingDeviceFailsImmediately) {
    LidarLive source(options(SerialDevice{"/dev/nonexistent"}));
    const auto next = next_of(source);
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr("/dev/nonexistent: cannot be opened (No such file or directory)"));
    EXPECT_THAT(notes_, IsEmpty());
    LidarLive other(options(SerialDevice{"/dev/null"}));
    EXPECT_THAT(next_of(other).error().message, HasSubstr("/dev/null: cannot be"));
}

TEST_F(Ld06Lives, HangUpFailsWithoutReopening) {
    PseudoTerminal sensor;
    auto once = options(SerialDevice{sensor.device()});
    once.device.reopen_for = std::chrono::milliseconds(0);
    LidarLive source(std::move(once));
    (void)scan_of(source, [&] { sensor.send(one_turn()); });
    const auto next = next_of(source, [&] { sensor.hang_up(); });
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr(sensor.device() + ": disconnected; check the cable"));
    EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(Ld06Lives, MissingDeviceFailsAfterTheReopenPeriod) {
    PseudoTerminal sensor;
    const auto path = std::filesystem::temp_directory_path() / fmt::format("scanloom-ld06-away-{}", ::getpid());
    std::filesystem::remove(path);
    std::filesystem::create_symlink(sensor.device(), path); // the system reuses names of terminals
    auto live = options(SerialDevice{path});
    live.device.reopen_for = std::chrono::milliseconds(150);
    LidarLive source(std::move(live));
    (void)scan_of(source, [&] { sensor.send(one_turn()); });
    const auto next = next_of(source, [&] {
        std::filesystem::remove(path);
        sensor.hang_up();
    });
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr("(retried for 0.15 s)"));
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("disconnected; check the cable; retrying for 0.15 s")));
}

TEST_F(Ld06Lives, ReconnectedDeviceContinues) {
    PseudoTerminal first;
    PseudoTerminal second;
    second.keep_open();
    const auto path = std::filesystem::temp_directory_path() / fmt::format("scanloom-ld06-{}", ::getpid());
    std::filesystem::remove(path);
    std::filesystem::create_symlink(first.device(), path); // as udev would name it
    LidarLive source(options(SerialDevice{path}));
    (void)scan_of(source, [&] { first.send(one_turn()); });
    on_note_ = [&, notes = 0]() mutable {
        if (++notes > 1) return;
        std::filesystem::remove(path);
        std::filesystem::create_symlink(second.device(), path);
        second.send(one_turn());
    };
    const Scan scan = scan_of(source, [&] { first.hang_up(); });
    EXPECT_EQ(scan.ranges.size(), 450U);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("disconnected"), HasSubstr("packets are received again")));
    std::filesystem::remove(path);
}

TEST_F(Ld06Lives, BytesWithoutPacketsAreReported) {
    const PseudoTerminal sensor;
    auto live = options(SerialDevice{sensor.device()});
    live.device.silent_max = std::chrono::milliseconds(1500); // a busy machine may not send for a while
    live.device.reopen_for = std::chrono::milliseconds(0);
    LidarLive source(std::move(live));
    asio::steady_timer timer(io_);
    const std::function<void()> babble = [&] {
        sensor.send(Bytes(40, 0x54));
        timer.expires_after(std::chrono::milliseconds(10));
        timer.async_wait([&](auto failed) {
            if (!failed && notes_.empty()) babble();
        });
    };
    const auto next = next_of(source, babble);
    ASSERT_FALSE(next);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("bytes without any packet of an LD06 for 1.5 s; is it another device, or "
                                              "a line speed other than 230400 baud?")));
    EXPECT_THAT(next.error().message, HasSubstr("no byte for 1.5 s"));
}

TEST_F(Ld06Lives, StopEndsTheSourceInAnyState) {
    const PseudoTerminal sensor;
    LidarLive source(options(SerialDevice{sensor.device()}));
    EXPECT_FALSE(next_of(source, [&] { source.stop(); }).value());
    EXPECT_FALSE(next_of(source).value()) << "the source stays ended";
    io_.restart();
    io_.run(); // must not leave pending work
    LidarLive unasked(options(SerialDevice{sensor.device()}));
    unasked.stop();
    EXPECT_FALSE(next_of(unasked).value());
}

TEST_F(Ld06Lives, CanBeDestroyedBeforeOrAfterItsExecutor) {
    const PseudoTerminal sensor;
    auto io = std::make_unique<asio::io_context>(1);
    auto outlives = std::make_unique<LidarLive>(options(SerialDevice{sensor.device()}));
    auto goes_first = std::make_unique<LidarLive>(options(SerialDevice{sensor.device()}));
    asio::co_spawn(*io, outlives->next(), asio::detached);
    asio::co_spawn(*io, goes_first->next(), asio::detached);
    io->poll();
    goes_first.reset();
    io->poll();
    io.reset();
    outlives.reset();
}

// Over TCP ------------------------------------------------------------------------------------------------------------

class Ld06OverTcp : public Ld06Lives {
protected:
    [[nodiscard]] LidarEndpoint endpoint() const {
        return net::Address{"127.0.0.1", std::to_string(acceptor_.local_endpoint().port())};
    }

    /// Accepts one connection per answer, sends the bytes and closes the connection.
    void serve(std::vector<Bytes> answers) {
        asio::co_spawn(
            io_,
            [](tcp::acceptor& acceptor, std::vector<Bytes> all) -> asio::awaitable<void> {
                for (const auto& bytes : all) {
                    tcp::socket socket = co_await acceptor.async_accept(asio::use_awaitable);
                    co_await asio::async_write(socket, asio::buffer(bytes), asio::use_awaitable);
                }
                acceptor.close();
            }(acceptor_, std::move(answers)),
            asio::detached);
    }

    tcp::acceptor acceptor_{io_, {asio::ip::make_address("127.0.0.1"), 0}};
};

TEST_F(Ld06OverTcp, GivesACompleteTurn) {
    serve({one_turn()});
    LidarLive source(options(endpoint()));
    EXPECT_EQ(scan_of(source).ranges.size(), 450U);
}

TEST_F(Ld06OverTcp, ReopensABrokenConnection) {
    serve({one_turn(), {}, one_turn()});
    LidarLive source(options(endpoint()));
    (void)scan_of(source);
    EXPECT_EQ(scan_of(source).ranges.size(), 450U);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("disconnected"), HasSubstr("packets are received again")));
    EXPECT_EQ(source.remarks(), "0 damaged packets, 2 turns")
        << "bytes after a break must not be joined to those before";
}

TEST_F(Ld06OverTcp, RefusedConnectionFailsImmediately) {
    const auto unused = endpoint();
    acceptor_.close();
    LidarLive source(options(unused));
    const auto next = next_of(source);
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr("cannot be reached (Connection refused)"));
}

TEST_F(Ld06OverTcp, SilentPeerFails) {
    auto live = options(endpoint());                         // accepted by the operating system, but never answered
    live.device.silent_max = std::chrono::milliseconds(500); // also limits the connect, which a busy machine may delay
    live.device.reopen_for = std::chrono::milliseconds(0);
    LidarLive source(std::move(live));
    EXPECT_THAT(next_of(source).error().message, HasSubstr("no byte for 0.5 s; check that the sensor has power"));
}

} // namespace
} // namespace scanloom::robot
