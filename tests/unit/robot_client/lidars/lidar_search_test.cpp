#include "robot_client/lidars/lidar_search.hpp"

#include "robot_client/lidars/lidar_models.hpp"
#include "tests/support/emulated_lidar.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <list>
#include <map>
#include <tuple>

namespace scanloom::robot {
namespace {

namespace asio = boost::asio;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::LidarEmulator;
using testing_support::PseudoTerminal;

using Found = Result<std::optional<LidarIdentity>>;

class LidarSearch : public testing::Test {
protected:
    /// Starts a search. The result is in searched() after run().
    void search(const std::string& name, LidarEndpoint endpoint, std::chrono::milliseconds answer_within) {
        asio::co_spawn(io_, identify_lidar(std::move(endpoint), answer_within),
                       [this, name](const std::exception_ptr& failed, Found found) {
                           if (failed) std::rethrow_exception(failed);
                           found_.emplace(name, std::move(found));
                       });
        ++searches_;
    }

    /// Starts a search at a terminal with an emulated sensor.
    void search(const std::string& name, std::shared_ptr<LidarEmulator> emulator) {
        auto& terminal = terminals_.emplace_back();
        terminal.keep_open();
        // Not as fast as the program reads: a terminal that is always full does not let the earlier attempts end.
        asio::co_spawn(io_,
                       testing_support::emulate(asio::posix::stream_descriptor(io_, terminal.duplicate()),
                                                std::move(emulator), std::chrono::milliseconds(20)),
                       asio::detached);
        search(name, SerialDevice{terminal.device()}, std::chrono::milliseconds(800));
    }

    void run() {
        while (found_.size() < searches_ && io_.run_one() > 0) {
        }
    }

    /// Returns the lidar of a search, or an empty one.
    [[nodiscard]] LidarIdentity lidar(const std::string& name) const {
        const auto& found = found_.at(name);
        EXPECT_TRUE(found && *found) << name;
        return found && *found ? **found : LidarIdentity{};
    }

    std::list<PseudoTerminal> terminals_;
    std::map<std::string, Found> found_;
    std::size_t searches_ = 0;
    asio::io_context io_{1};
};

TEST_F(LidarSearch, IdentifiesEachModel) {
    for (const auto& model : lidar_models()) {
        search(std::string(model.name), testing_support::make_lidar_emulator(model.name));
    }
    run();
    for (const auto& model : lidar_models()) {
        const std::string name(model.name);
        EXPECT_EQ(lidar(name).model, name == "ld19" ? "ld06" : name) << "an LD19 sends what an LD06 sends";
        EXPECT_EQ(lidar(name).baud, 0U);
    }
    EXPECT_EQ(lidar("rplidar-a1").text, "RPLIDAR A1, model 24, firmware 1.20, serial A0A1A2A3A4A5A6A7A8A9AAABACADAEAF");
    EXPECT_EQ(lidar("hokuyo").text, "Hokuyo UST-10LX, firmware CE00486, serial H1234567");
}

TEST_F(LidarSearch, ASensorThatMeasuresIsStoppedAndIdentified) {
    auto emulator = std::make_shared<testing_support::RplidarEmulator>();
    const std::vector<std::uint8_t> scan{0xA5, 0x20};
    (void)emulator->receive(scan);
    search("rplidar", emulator);
    run();
    EXPECT_EQ(lidar("rplidar").model, "rplidar-a1");
    EXPECT_FALSE(emulator->is_measuring());
}

TEST_F(LidarSearch, ASilentDeviceIsNoLidar) {
    auto& terminal = terminals_.emplace_back();
    terminal.keep_open();
    search("silent", SerialDevice{terminal.device()}, std::chrono::milliseconds(10));
    search("missing", SerialDevice{"/dev/nonexistent"}, std::chrono::milliseconds(10));
    run();
    ASSERT_TRUE(found_.at("silent")) << found_.at("silent").error().message;
    EXPECT_FALSE(*found_.at("silent"));
    EXPECT_THAT(found_.at("missing").error().message, HasSubstr("/dev/nonexistent: cannot be opened"));
}

TEST(LidarProbes, DistinguishTheStl27lFromTheLd06AtAnyRateOfTheLine) {
    using testing_support::Ld06Emulator;
    for (const bool is_stl27l : {false, true}) {
        const auto bytes = Ld06Emulator(is_stl27l).next_turn();
        std::map<unsigned, std::string> found;
        for (const auto& probe : lidar_probes()) {
            if (const auto lidar = probe.identify(bytes)) found[probe.baud] = lidar->model;
        }
        const std::string model = is_stl27l ? "stl27l" : "ld06";
        EXPECT_THAT(found, ElementsAre(std::pair(230'400U, model), std::pair(921'600U, model)));
    }
}

/// Published packets with the fewest and the most samples per second; see Ld06Packet.ReadsTheKnownVectors.
TEST(LidarProbes, TakePublishedPacketsOfAnLd06ForThoseOfAnLd06) {
    for (const auto& [speed, start, end] : {std::tuple{2152, 32'427, 33'470}, std::tuple{3566, 33'864, 34'645}}) {
        Ld06Packet packet;
        packet.speed = static_cast<std::uint16_t>(speed);
        packet.start_angle = static_cast<std::uint16_t>(start);
        packet.end_angle = static_cast<std::uint16_t>(end);
        testing_support::Bytes bytes;
        for (int packets = 0; packets < 3; ++packets) testing_support::append(bytes, testing_support::bytes_of(packet));
        const auto lidar = lidar_probes().front().identify(bytes);
        ASSERT_TRUE(lidar);
        EXPECT_EQ(lidar->model, "ld06") << speed;
    }
}

TEST(SerialDevices, AreNamedByTheirMakerIfPossible) {
    const TemporaryDirectory dev;
    EXPECT_THAT(serial_devices(dev.path()), IsEmpty());
    for (const char* name : {"ttyUSB0", "ttyUSB1", "ttyACM0", "tty0", "ttyS0"}) std::ofstream(dev.path() / name) << "";
    std::filesystem::create_directories(dev.path() / "serial" / "by-id");
    std::filesystem::create_symlink("../../ttyUSB1", dev.path() / "serial" / "by-id" / "usb-Maker_1");
    EXPECT_THAT(serial_devices(dev.path()), ElementsAre(dev.path() / "serial" / "by-id" / "usb-Maker_1",
                                                        dev.path() / "ttyACM0", dev.path() / "ttyUSB0"));
}

} // namespace
} // namespace scanloom::robot
