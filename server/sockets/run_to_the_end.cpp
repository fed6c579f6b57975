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
            spdlog::error("something that was to be done on an I/O thread failed: {}", failure.what());
        } catch (...) {
            spdlog::error("something that was to be done on an I/O thread failed");
        }
    }
}

} // namespace scanloom::sockets
