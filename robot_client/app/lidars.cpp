#include "robot_client/app/lidars.hpp"

#include "common/net/connect.hpp"
#include "robot_client/lidars/lidar_search.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>

namespace scanloom::robot {
namespace {

LidarEndpoint endpoint_of(const std::string& device) {
    if (!device.starts_with(kTcpScheme)) return SerialDevice{device};
    return net::parse_address(device.substr(kTcpScheme.size())).value(); // the options were checked
}

std::string text_of(const ProbedDevice& device) {
    if (!device.lidar) return fmt::format("{}\n", device.lidar.error().message);
    if (!*device.lidar) {
        return fmt::format("{}: no known lidar answers; check that it has power, and that no other program reads it\n",
                           device.name);
    }
    const LidarIdentity& lidar = **device.lidar;
    const auto baud = lidar.baud > 0 ? fmt::format(" --baud {}", lidar.baud) : "";
    return fmt::format("{}: {}\n  scanloom-robot --server HOST:7447 --session NAME --robot NAME lidar {} {} --poses "
                       "none{}\n",
                       device.name, lidar.text, lidar.model, device.name, baud);
}

} // namespace

std::string lidars_text(const std::vector<ProbedDevice>& devices) {
    if (devices.empty()) {
        return "no serial device of a USB adapter was found (/dev/ttyUSB*, /dev/ttyACM*); plug one in, or name a "
               "DEVICE\n";
    }
    std::string text;
    for (const auto& device : devices) text += text_of(device);
    return text;
}

ExitCode run(const LidarsOptions& options) {
    const auto names = options.devices.empty() ? serial_devices() : options.devices;
    std::vector<ProbedDevice> devices;
    for (const auto& name : names) devices.push_back({name, std::optional<LidarIdentity>{}});
    boost::asio::io_context io(1);
    for (auto& device : devices) {
        const auto wait = std::chrono::milliseconds(static_cast<std::int64_t>(options.wait * 1e3));
        boost::asio::co_spawn(io, identify_lidar(endpoint_of(device.name), wait),
                              [&device](const std::exception_ptr& failed, auto found) {
                                  if (failed) std::rethrow_exception(failed);
                                  device.lidar = std::move(found);
                              });
    }
    io.run();
    fmt::print("{}", lidars_text(devices));
    const bool is_found =
        std::ranges::any_of(devices, [](const auto& device) { return device.lidar && *device.lidar; });
    return is_found ? kExitDone : kExitFailed;
}

} // namespace scanloom::robot
