#include "load/net/audience.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>

#include <future>

namespace scanloom::load {

namespace asio = boost::asio;

Audience::Audience(const AudiencePlan& plan, const RunClock& clock)
    : plan_(plan), shared_{clock, plan.http, figures_}, thread_([this] { io_.run(); }) {}

Audience::~Audience() { stop(); }

void Audience::begin() {
    const auto session = [this](std::uint32_t number) { return plan_.sessions[number % plan_.sessions.size()]; };
    for (std::uint32_t i = 0; i < plan_.viewers; ++i) {
        asio::co_spawn(io_, watch(shared_, session(i)), asio::detached);
    }
    for (std::uint32_t i = 0; i < plan_.tile_readers; ++i) {
        const auto delay = static_cast<Micros>(i * static_cast<double>(kSecond) / plan_.tile_rate / plan_.tile_readers);
        asio::co_spawn(io_, read_tiles(shared_, session(i), plan_.tile_rate, delay), asio::detached);
    }
}

std::unique_ptr<AudienceFigures> Audience::look() {
    if (!thread_.joinable()) return std::make_unique<AudienceFigures>(figures_);
    std::promise<std::unique_ptr<AudienceFigures>> seen;
    asio::post(io_, [&] { seen.set_value(std::make_unique<AudienceFigures>(figures_)); });
    return seen.get_future().get();
}

void Audience::stop() {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] {
        shared_.stopped = true;
        io_.stop();
    });
    thread_.join();
}

} // namespace scanloom::load
