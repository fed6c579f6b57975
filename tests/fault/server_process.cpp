#include "tests/fault/server_process.hpp"

#include "tests/support/running_server.hpp"

#include <fmt/format.h>

#include <csignal>
#include <fstream>
#include <stdexcept>

namespace scanloom::fault {
ReservedPort::ReservedPort() {
    using boost::asio::ip::tcp;
    socket_.open(tcp::v4());
    socket_.set_option(tcp::socket::reuse_address(true)); // like the server, so that both may bind the port
    socket_.bind({boost::asio::ip::address_v4::loopback(), 0});
}

ServerProcess::ServerProcess(Command command, std::filesystem::path place, std::vector<std::string> options,
                             std::string store)
    : command_(std::move(command)), place_(std::move(place)), options_(std::move(options)),
      store_(store.empty() ? (place_ / "store").string() : std::move(store)) {
    if (command_.program.empty()) command_.program = test::program("scanloom-server");
}

void ServerProcess::start() {
    std::vector<std::string> words = command_.words;
    for (const auto& word :
         {std::string("--store"), store_, std::string("--listen"), fmt::format("127.0.0.1:{}", robot_port()),
          std::string("--http"), fmt::format("127.0.0.1:{}", http_port())}) {
        words.push_back(word);
    }
    words.insert(words.end(), options_.begin(), options_.end());
    process_.emplace(command_.program, words, place_ / "log");
}

void ServerProcess::start_and_wait() {
    start();
    if (becomes_ready()) return;
    throw std::runtime_error(fmt::format("the server ended with {} before it was ready: {}", wait(), last_words()));
}

void ServerProcess::kill_nine() {
    signal(SIGKILL);
    (void)wait();
}

int ServerProcess::stop() {
    signal(SIGTERM);
    return wait();
}

std::string ServerProcess::last_words() const {
    std::ifstream in(place_ / "log");
    std::string last;
    for (std::string line; std::getline(in, line);) last = line;
    return last;
}

} // namespace scanloom::fault
