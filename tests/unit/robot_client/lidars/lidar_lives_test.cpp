#include "robot_client/lidars/lidar_models.hpp"
#include "tests/support/emulated_lidar.hpp"
#include "tests/unit/robot_client/lidars/ld06_live_fixture.hpp"

#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <gmock/gmock.h>

#include <sys/ioctl.h>

#include <algorithm>
#include <array>

namespace scanloom::robot {
namespace {

using asio::ip::tcp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::LidarEmulator;

/// Every model with its emulator on a line.
class LidarLives : public Ld06Lives {
protected:
    LidarLiveOptions options_for(std::string_view name, LidarEndpoint endpoint) {
        const LidarModel& model = *find_lidar_model(name);
        auto live = options(std::move(endpoint));
        live.device.serial = model.serial;
        live.driver = make_lidar_driver(model, scan_options(model, {}).value());
        return live;
    }

    /// Emulates a sensor at a terminal.
    std::shared_ptr<LidarEmulator> plug_in(const PseudoTerminal& terminal, std::shared_ptr<LidarEmulator> emulator) {
        asio::co_spawn(io_,
                       testing_support::emulate(asio::posix::stream_descriptor(io_, terminal.duplicate()), emulator),
                       asio::detached);
        return emulator;
    }
};

class EachLidar : public LidarLives, public testing::WithParamInterface<LidarModel> {};

TEST_P(EachLidar, GivesScansOverASerialLine) {
    PseudoTerminal terminal;
    terminal.keep_open();
    plug_in(terminal, testing_support::make_lidar_emulator(GetParam().name));
    LidarLive source(options_for(GetParam().name, SerialDevice{terminal.device()}));
    const Scan first = scan_of(source);
    const Scan second = scan_of(source);
    EXPECT_GE(first.ranges.size(), 360U);
    EXPECT_EQ(second.ranges.size(), first.ranges.size());
    EXPECT_EQ(first.pose, (Pose2{1.0, 2.0, 0.5}));
    EXPECT_NEAR(first.stamp, unix_now(), 60.0) << "stamps are Unix time";
    EXPECT_GE(second.stamp, first.stamp - 0.2);
    EXPECT_THAT(source.remarks(), HasSubstr("0 damaged packets"));
}

INSTANTIATE_TEST_SUITE_P(Models, EachLidar, testing::ValuesIn(lidar_models().begin(), lidar_models().end()),
                         [](const auto& each) {
                             std::string name(each.param.name);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST_F(LidarLives, HokuyoGivesScansOverTcp) {
    tcp::acceptor acceptor(io_, {asio::ip::make_address("127.0.0.1"), 0});
    asio::co_spawn(
        io_,
        [](tcp::acceptor& listening) -> asio::awaitable<void> {
            auto socket = co_await listening.async_accept(asio::use_awaitable);
            co_await testing_support::emulate(std::move(socket), std::make_shared<testing_support::HokuyoEmulator>());
        }(acceptor),
        asio::detached);
    LidarLive source(
        options_for("hokuyo", net::Address{"127.0.0.1", std::to_string(acceptor.local_endpoint().port())}));
    const Scan scan = scan_of(source);
    EXPECT_EQ(scan.ranges.size(), 1081U);
    EXPECT_EQ(scan.ranges[540], 1540U) << "ahead";
    EXPECT_THAT(notes_, ElementsAre(HasSubstr(": Hokuyo UST-10LX, serial H1234567")));
}

TEST_F(LidarLives, ASensorIsStoppedWhenItsSourceEnds) {
    PseudoTerminal terminal;
    terminal.keep_open();
    const auto emulator = plug_in(terminal, std::make_shared<testing_support::RplidarEmulator>());
    auto source = std::make_unique<LidarLive>(options_for("rplidar-a1", SerialDevice{terminal.device()}));
    (void)scan_of(*source);
    EXPECT_TRUE(emulator->is_measuring());
    source->stop();
    io_.restart();
    while (emulator->is_measuring() && io_.run_one() > 0) {
    }
    EXPECT_FALSE(emulator->is_measuring());
    EXPECT_THAT(emulator->commands(), testing::IsSupersetOf({"25", "50", "52", "20", "F0"}));
}

TEST_F(LidarLives, ASerialLineHasTheRateOfTheModel) {
    PseudoTerminal terminal;
    terminal.keep_open();
    plug_in(terminal, std::make_shared<testing_support::YdlidarEmulator>(false));
    LidarLive source(options_for("ydlidar-x4", SerialDevice{terminal.device()}));
    (void)scan_of(source);
    std::array<unsigned, 11> settings{}; // struct termios2 of Linux, which ends with the two speeds
    const int line = terminal.duplicate();
    ASSERT_EQ(::ioctl(line, _IOR('T', 0x2A, settings), settings.data()), 0);
    ::close(line);
    EXPECT_EQ(settings[10], 128'000U) << "not one of the standard rates";
}

TEST_F(LidarLives, ABrokenSensorFailsWithItsError) {
    PseudoTerminal terminal;
    terminal.keep_open();
    plug_in(terminal, std::make_shared<testing_support::RplidarEmulator>(testing_support::A5Emulation{.condition = 2}));
    auto live = options_for("rplidar-a1", SerialDevice{terminal.device()});
    live.device.reopen_for = std::chrono::milliseconds(150);
    LidarLive source(std::move(live));
    const auto next = next_of(source);
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr("reports that it is broken (error 0x8002)"));
    EXPECT_THAT(next.error().message, HasSubstr("(retried for 0.15 s)"));
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("firmware 1.15"), HasSubstr("retrying for 0.15 s")));
}

TEST_F(LidarLives, AnotherDeviceFails) {
    PseudoTerminal terminal;
    terminal.keep_open();
    plug_in(terminal, std::make_shared<testing_support::Ld06Emulator>());
    auto live = options_for("rplidar-a1", SerialDevice{terminal.device()});
    live.device.reopen_for = std::chrono::milliseconds(0);
    LidarLive source(std::move(live));
    const auto next = next_of(source);
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message, HasSubstr("no answer of an RPLIDAR A1 to a request; is it another device"));
}

} // namespace
} // namespace scanloom::robot
