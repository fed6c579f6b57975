#include "tests/support/emulated_lidar.hpp"
#include "tests/support/pseudo_terminal.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <csignal>
#include <string_view>

namespace {

namespace asio = boost::asio;
using namespace scanloom::testing_support;

constexpr std::chrono::milliseconds kTurn{100};

asio::awaitable<void> serve(asio::ip::tcp::acceptor acceptor, std::string model) {
    for (;;) {
        auto socket = co_await acceptor.async_accept(asio::use_awaitable);
        co_await emulate(std::move(socket), std::shared_ptr(make_lidar_emulator(model)), kTurn);
    }
}

} // namespace

/// Emulates a lidar for other programs: lidar_emulator MODEL tcp|serial. Prints where it is, and runs until a signal.
int main(int argc, char** argv) {
    const std::string model = argc == 3 ? argv[1] : "";
    if (!make_lidar_emulator(model)) {
        fmt::print(stderr, "lidar_emulator: name a MODEL and tcp or serial\n");
        return 2;
    }
    std::signal(SIGPIPE, SIG_IGN);
    asio::io_context io(1);
    PseudoTerminal terminal;
    if (argv[2] == std::string_view("tcp")) {
        asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
        fmt::print("tcp://127.0.0.1:{}\n", acceptor.local_endpoint().port());
        asio::co_spawn(io, serve(std::move(acceptor), model), asio::detached);
    } else {
        terminal.keep_open();
        fmt::print("{}\n", terminal.device());
        asio::posix::stream_descriptor line(io, terminal.duplicate());
        asio::co_spawn(io, emulate(std::move(line), std::shared_ptr(make_lidar_emulator(model)), kTurn),
                       asio::detached);
    }
    (void)std::fflush(stdout);
    io.run();
    return 0;
}
