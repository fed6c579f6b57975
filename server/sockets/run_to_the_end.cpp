#include "server/sockets/run_to_the_end.hpp"

#include <spdlog/spdlog.h>

#include <exception>

namespace scanloom::sockets {

void run_to_the_end(boost::asio::io_context& io) noexcept {
    for (;;) {
        try {
            io.run();
            return;
        } catch (const std::exception& failure) {
            spdlog::error("a task failed: {}", failure.what());
        } catch (...) {
            spdlog::error("a task failed");
        }
    }
}

} // namespace scanloom::sockets
