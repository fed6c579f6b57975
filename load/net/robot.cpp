#include "load/net/robot.hpp"

#include "common/net/await_tuple.hpp"
#include "load/core/figure_text.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr std::size_t kReadBytes = 512; // acks have about twenty bytes each
constexpr std::chrono::seconds kConnectMax{10};

} // namespace

void Troubles::add(const Troubles& other) {
    for (const auto& failure : other.failures) {
        if (failures.size() < kKept) failures.push_back(failure);
    }
    if (newest.empty()) newest = other.newest;
}

struct Robot::Link {
    explicit Link(net::LinkStream connected) : stream(std::move(connected)) {}

    net::LinkStream stream;
    bool is_up = false; // connected, and encrypted if required
    bool is_writing = false;
    bool has_heard = false; // received anything
    std::string out;
};

Robot::Robot(RobotPlan plan, Shared shared)
    : shared_(shared), client_(std::move(plan), shared.workload, shared.link.hello),
      servers_(shared.link.servers, client_.plan().session), backoff_(client_.plan().index + 1), timer_(shared.io) {}

void Robot::start() { asio::co_spawn(shared_.io, run(), asio::detached); }

asio::awaitable<void> Robot::run() {
    while (!stopped_) {
        const wire::LinkError failure = co_await use_one_link();
        const bool was_struck = std::exchange(struck_, false);
        close_link();
        client_.close(shared_.figures);
        if (stopped_ || client_.is_done()) break;
        if (was_struck) continue; // a radio link is back immediately
        if (failure.retryable && servers_.choose_another(failure.address)) continue;
        note(failure);
        if (failed_) break;
        timer_.expires_after(std::min<std::chrono::steady_clock::duration>(backoff_.next(), servers_.wait_max()));
        co_await timer_.async_wait(kAwaitTuple);
    }
    if (client_.is_done()) ++shared_.figures.finished;
}

void Robot::note(const wire::LinkError& failure) {
    const auto text = harmless(
        fmt::format("robot {} of session {}: {}", client_.plan().name, client_.plan().session, failure.error.message));
    Troubles& troubles = shared_.troubles;
    if (failure.retryable) {
        troubles.newest = text;
        return;
    }
    failed_ = true;
    ++shared_.figures.failed;
    if (troubles.failures.size() < Troubles::kKept) troubles.failures.push_back(text);
}

// A link
// ---------------------------------------------------------------------------------------------------------------

asio::awaitable<wire::LinkError> Robot::use_one_link() {
    link_ = std::make_shared<Link>(net::client_stream(shared_.io.get_executor(), shared_.link.tls));
    const auto link = link_;
    const auto index = servers_.index();
    const auto timeout = servers_.connect_max(kConnectMax);
    auto connecting = index ? net::connect(link->stream, servers_.current(), shared_.link.endpoints[*index], timeout)
                            : net::connect(link->stream, servers_.current(), timeout);
    const auto connected = co_await std::move(connecting);
    if (!connected) co_return wire::LinkError{connected.error(), true};
    if (const auto time = servers_.unconfirmed_max()) net::set_unconfirmed_max(link->stream, *time);
    link->is_up = true;
    client_.open(servers_.current().text(), shared_.clock.now(), servers_.has_others());
    flush();
    co_return co_await read_frames(link);
}

asio::awaitable<wire::LinkError> Robot::read_frames(std::shared_ptr<Link> link) {
    for (;;) {
        const auto room = client_.prepare(kReadBytes);
        const auto [failed, count] =
            co_await link->stream.async_read_some(asio::buffer(room.data(), room.size()), kAwaitTuple);
        if (failed) co_return ended(*link, failed);
        while (shared_.clock.now() < stalled_until_ && !stopped_) {
            timer_.expires_at(shared_.clock.at(stalled_until_));
            co_await timer_.async_wait(kAwaitTuple);
        }
        if (auto failure = take(*link, count)) co_return *failure;
        flush();
    }
}

/// A server that requires TLS closes the connection after the first bytes that are not TLS.
wire::LinkError Robot::ended(const Link& link, const boost::system::error_code& why) const {
    const bool may_want_tls = !shared_.link.tls && !link.has_heard;
    return {{Errc::kUnreachable,
             fmt::format("the connection was lost: {}{}", net::failure_text(link.stream, why),
                         may_want_tls ? " before the server said a word; it may want TLS (--tls)" : "")},
            true};
}

std::optional<wire::LinkError> Robot::take(Link& link, std::size_t bytes) {
    shared_.figures.bytes_in += bytes;
    link.has_heard = true;
    const std::uint64_t before = client_.acknowledged();
    auto failure = client_.on_bytes(bytes, shared_.clock.now(), shared_.figures);
    if (client_.acknowledged() > before) backoff_.reset();
    if (client_.is_welcome()) servers_.settle();
    return failure;
}

void Robot::flush() {
    const auto link = link_;
    if (!link || !link->is_up || link->is_writing || shared_.clock.now() < stalled_until_) return;
    client_.write(link->out, shared_.clock.now(), shared_.figures);
    if (link->out.empty()) return;
    link->is_writing = true;
    asio::async_write(link->stream, asio::buffer(link->out),
                      [this, link](const boost::system::error_code& failed, std::size_t count) {
                          shared_.figures.bytes_out += count;
                          link->is_writing = false;
                          link->out.clear();
                          if (failed && link != abandoned_) link->stream.close(); // the pending read then fails
                          if (!failed && link == link_) flush();
                      });
}

void Robot::close_link() {
    if (link_ && link_ != abandoned_) link_->stream.close();
    link_.reset();
}

// Events --------------------------------------------------------------------------------------------------------------

void Robot::due(std::uint64_t scans) {
    client_.due(scans, shared_.clock.now());
    flush();
}

void Robot::end() {
    client_.end();
    flush();
}

void Robot::look_after(Micros now) {
    if (!link_ || now < stalled_until_) return;
    const auto failure = client_.check(now);
    if (failure) {
        note(*failure);
        link_->stream.close();
    } else {
        flush();
    }
}

bool Robot::strike(Fault fault) {
    if (!client_.is_welcome() || !link_ || shared_.clock.now() < stalled_until_ || stopped_) return false;
    boost::system::error_code ignored;
    auto& socket = link_->stream.socket();
    switch (fault) {
    case Fault::kStall: stalled_until_ = shared_.clock.now() + kStallTime; return true;
    case Fault::kCut:
        socket.set_option(asio::socket_base::linger(true, 0), ignored); // resets the connection instead of closing it
        link_->stream.close();
        break;
    case Fault::kHalfOpen:
        if (abandoned_) abandoned_->stream.close();
        abandoned_ = link_;
        socket.cancel(ignored);
        break;
    }
    struck_ = true;
    return true;
}

void Robot::stop() {
    stopped_ = true;
    stalled_until_ = 0;
    if (link_) link_->stream.close();
    if (abandoned_) abandoned_->stream.close();
    timer_.cancel();
}

} // namespace scanloom::load
