#include "robot_client/lidars/lidar_line.hpp"

#include "common/error/error.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

namespace scanloom::robot {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// The settings of a terminal as Linux knows them, `struct termios2` of <asm/termbits.h>: unlike those of <termios.h>
/// they hold any rate, such as the 128,000 baud of a YDLIDAR X4.
struct KernelTermios {
    unsigned input_flags;
    unsigned output_flags;
    unsigned control_flags;
    unsigned local_flags;
    unsigned char line_discipline;
    unsigned char control_characters[19];
    unsigned input_speed;
    unsigned output_speed;
};
constexpr unsigned long kGetSettings = _IOR('T', 0x2A, KernelTermios);
constexpr unsigned long kSetSettings = _IOW('T', 0x2B, KernelTermios);
constexpr unsigned kAnySpeed = 0010000; // BOTHER: the speeds are numbers

error_code set_speed(int descriptor, unsigned baud) {
    KernelTermios settings{};
    const auto last_error = [] { return error_code(errno, boost::system::system_category()); };
    if (::ioctl(descriptor, kGetSettings, &settings) != 0) return last_error();
    settings.control_flags = (settings.control_flags & ~static_cast<unsigned>(CBAUD)) | kAnySpeed;
    settings.input_speed = settings.output_speed = baud;
    if (::ioctl(descriptor, kSetSettings, &settings) != 0) return last_error();
    return {};
}

Error cannot_be_set(unsigned baud, const error_code& failed) {
    return Error{Errc::kUnreachable,
                 fmt::format("cannot be set to {} baud ({}); is it a serial device?", baud, failed.message())};
}

Result<> set_line(asio::serial_port& port, const SerialSettings& settings) {
    using Port = asio::serial_port;
    error_code failed;
    const auto set = [&](auto option) {
        if (!failed) (void)port.set_option(option, failed);
    };
    set(Port::character_size(8));
    set(Port::parity(Port::parity::none));
    set(Port::stop_bits(Port::stop_bits::one));
    set(Port::flow_control(Port::flow_control::none));
    if (!failed) failed = set_speed(port.native_handle(), settings.baud); // last: others would set a standard speed
    if (failed) return cannot_be_set(settings.baud, failed);
    if (settings.dtr) {
        int line = TIOCM_DTR;
        (void)::ioctl(port.native_handle(), *settings.dtr ? TIOCMBIS : TIOCMBIC, &line);
    }
    return {};
}

asio::awaitable<Result<LidarLine>> open(SerialDevice device, SerialSettings settings, std::chrono::milliseconds) {
    asio::serial_port port(co_await asio::this_coro::executor);
    error_code failed;
    (void)port.open(device.path, failed);
    if (failed) {
        co_return Error{
            Errc::kUnreachable,
            fmt::format(
                "cannot be opened ({}); check its cable, its name and your permission to read it (group dialout)",
                failed.message())};
    }
    if (auto set = set_line(port, settings); !set) co_return set.error();
    co_return LidarLine(std::move(port));
}

asio::awaitable<error_code> connect(tcp::socket& socket, const net::Address& peer) {
    tcp::resolver resolver(co_await asio::this_coro::executor);
    auto [unknown, addresses] = co_await resolver.async_resolve(peer.host, peer.port, kAwaitTuple);
    if (unknown) co_return unknown;
    co_return std::get<0>(co_await asio::async_connect(socket, addresses, kAwaitTuple));
}

asio::awaitable<Result<LidarLine>> open(net::Address peer, SerialSettings, std::chrono::milliseconds timeout) {
    const auto executor = co_await asio::this_coro::executor;
    tcp::socket socket(executor);
    const auto failed = co_await net::within(timeout, connect(socket, peer));
    if (failed && !*failed) co_return LidarLine(std::move(socket));
    const std::string why = failed ? failed->message() : fmt::format("no answer for {:g} s", seconds(timeout));
    co_return Error{
        Errc::kUnreachable,
        fmt::format("cannot be reached ({}); check the address and that the lidar or ser2net listens there", why)};
}

} // namespace

std::string name_of(const LidarEndpoint& endpoint) {
    if (const auto* device = std::get_if<SerialDevice>(&endpoint)) return device->path;
    return "tcp://" + std::get<net::Address>(endpoint).text();
}

asio::awaitable<Result<LidarLine>> open_line(LidarEndpoint endpoint, SerialSettings settings,
                                             std::chrono::milliseconds timeout) {
    auto line = co_await std::visit([&](auto& there) { return open(there, settings, timeout); }, endpoint);
    if (!line) co_return prefixed(name_of(endpoint) + ": ", line.error());
    co_return line;
}

Result<> set_baud(LidarLine& line, unsigned baud) {
    auto* port = std::get_if<asio::serial_port>(&line);
    if (port == nullptr) return {};
    if (const auto failed = set_speed(port->native_handle(), baud)) return cannot_be_set(baud, failed);
    (void)::tcflush(port->native_handle(), TCIFLUSH);
    return {};
}

asio::awaitable<Result<std::optional<std::size_t>>> read_some(LidarLine& line, std::span<std::uint8_t> bytes,
                                                              std::chrono::milliseconds timeout) {
    const auto buffer = asio::buffer(bytes.data(), bytes.size());
    const auto read = co_await net::within(
        timeout, std::visit([&](auto& open) { return open.async_read_some(buffer, kAwaitTuple); }, line));
    if (!read) co_return std::nullopt;
    const auto [failed, count] = *read;
    if (!failed) co_return std::optional(count);
    // a terminal without its other end reports an I/O error
    const bool hung_up = failed == asio::error::eof || failed == error_code(EIO, boost::system::system_category());
    co_return Error{Errc::kUnreachable,
                    hung_up ? "disconnected; check the cable" : fmt::format("cannot be read ({})", failed.message())};
}

asio::awaitable<Result<>> write_all(LidarLine& line, std::span<const std::uint8_t> bytes,
                                    std::chrono::milliseconds timeout) {
    const auto buffer = asio::buffer(bytes.data(), bytes.size());
    const auto written = co_await net::within(
        timeout, std::visit([&](auto& open) { return asio::async_write(open, buffer, kAwaitTuple); }, line));
    if (written && !std::get<0>(*written)) co_return Result<>{};
    const std::string why =
        written ? std::get<0>(*written).message() : fmt::format("not accepted for {:g} s", seconds(timeout));
    co_return Error{Errc::kUnreachable, fmt::format("cannot be written ({}); check the cable", why)};
}

void write_last(LidarLine& line, std::span<const std::uint8_t> bytes) noexcept {
    if (bytes.empty()) return;
    if (auto* port = std::get_if<asio::serial_port>(&line)) {
        if (::write(port->native_handle(), bytes.data(), bytes.size()) < 0) return; // does not wait: it was read before
        return;
    }
    auto& socket = std::get<tcp::socket>(line);
    error_code ignored;
    (void)socket.non_blocking(true, ignored);
    (void)socket.write_some(asio::buffer(bytes.data(), bytes.size()), ignored);
}

} // namespace scanloom::robot
