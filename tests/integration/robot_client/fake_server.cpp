#include "tests/integration/robot_client/fake_server.hpp"

#include "common/net/await_tuple.hpp"
#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace scanloom::robot {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {} // namespace

struct FakeServer::Link {
    net::LinkStream socket;
    LinkScript script;
    std::set<std::uint32_t> sensors;
    std::uint64_t scans = 0;
    std::uint64_t batches = 0;
    std::uint64_t requests = 0;
    std::size_t unacknowledged_bytes = 0;
    bool is_silent = false;

    asio::awaitable<bool> send(const wire::Message& message) {
        if (is_silent) co_return true;
        std::string frame;
        wire::encode(message, frame);
        const auto [failed, count] = co_await asio::async_write(socket, asio::buffer(frame), kAwaitTuple);
        co_return !failed;
    }
};

FakeServer::FakeServer(asio::io_context& io, std::vector<LinkScript> scripts)
    : io_(io), acceptor_(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0)), endpoint_(acceptor_.local_endpoint()),
      scripts_(std::move(scripts)) {
    asio::co_spawn(io_, accept(), asio::detached);
}

void FakeServer::store_before(std::uint64_t scans) {
    stored_.resize(scans);
    for (std::uint64_t i = 0; i < scans; ++i) stored_[i].seq = i + 1;
    durable_ = scans;
}

void FakeServer::close() { acceptor_.close(); }

void FakeServer::reopen() {
    acceptor_.open(endpoint_.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint_);
    acceptor_.listen();
    asio::co_spawn(io_, accept(), asio::detached);
}

asio::awaitable<void> FakeServer::accept() {
    for (;;) {
        auto [failed, socket] = co_await acceptor_.async_accept(kAwaitTuple);
        if (failed) co_return;
        LinkScript script = scripts_[std::min(links_++, scripts_.size() - 1)];
        asio::co_spawn(io_, serve(std::move(socket), std::move(script)), asio::detached);
    }
}

asio::awaitable<void> FakeServer::serve(Socket socket, LinkScript script) {
    net::LinkStream stream = tls_ ? net::LinkStream(std::move(socket), *tls_) : net::LinkStream(std::move(socket));
    Link link{std::move(stream), std::move(script), {}, 0, 0, 0, 0, false};
    const auto [refused] = co_await link.socket.async_handshake(net::LinkStream::Role::kServer, kAwaitTuple);
    if (refused) co_return;
    wire::FrameDecoder decoder(wire::kFrameBytesMax);
    for (;;) {
        const auto room = decoder.prepare(4096);
        const auto [failed, count] =
            co_await link.socket.async_read_some(asio::buffer(room.data(), room.size()), kAwaitTuple);
        if (failed) co_return;
        decoder.commit(count);
        for (;;) {
            const auto body = decoder.next();
            if (!body) co_return; // no frames: the robot uses another protocol
            if (!*body) break;
            auto message = wire::decode(**body);
            std::size_t frame_bytes = (*body)->size() + wire::kLengthPrefixBytes;
            if (const auto* compressed = message ? std::get_if<wire::CompressedScanBatch>(&*message) : nullptr) {
                ++compressed_batches_;
                frame_bytes = wire::bytes_under_way(*compressed);
                auto batch = wire::decompress(*compressed);
                message = batch ? Result<wire::Message>(std::move(*batch)) : Result<wire::Message>(batch.error());
            }
            if (!message) {
                faults_.push_back(message.error().message);
                co_return;
            }
            if (!co_await answer(link, *message, frame_bytes)) co_return;
        }
    }
}

asio::awaitable<bool> FakeServer::answer(Link& link, const wire::Message& message, std::size_t frame_bytes) {
    if (const auto* hello = std::get_if<wire::Hello>(&message)) co_return co_await greet(link, *hello);
    if (const auto* sensor = std::get_if<Sensor>(&message)) link.sensors.insert(sensor->id);
    if (const auto* ping = std::get_if<wire::Ping>(&message)) {
        const wire::Message pong = wire::Pong{ping->nonce};
        co_return co_await link.send(pong);
    }
    if (std::holds_alternative<wire::Goodbye>(message)) {
        ++goodbyes_;
        co_return false;
    }
    if (const auto* plan = std::get_if<wire::PlanRequest>(&message)) co_return co_await meet(link, *plan);
    if (const auto* locate = std::get_if<wire::LocateRequest>(&message)) co_return co_await meet(link, *locate);
    if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) co_return co_await take(link, *batch, frame_bytes);
    co_return true;
}

asio::awaitable<bool> FakeServer::greet(Link& link, const wire::Hello& hello) {
    hellos_.push_back(hello);
    link.is_silent = link.script.silent_after_scans == 0;
    if (link.script.refuse_hello) {
        const wire::Message refusal = *link.script.refuse_hello;
        co_await link.send(refusal);
        co_return false;
    }
    if (link.script.answer_hello_with) {
        co_await asio::async_write(link.socket, asio::buffer(*link.script.answer_hello_with), kAwaitTuple);
        co_return false;
    }
    durable_ = stored_.size(); // scans that were stored without acknowledgement survive
    // Messages have names here: g++ 12 destroys temporaries of aggregate types twice when a co_await follows them.
    const wire::Message welcome = wire::Welcome{link.script.session_id,
                                                link.script.durable_seq.value_or(durable_),
                                                {},
                                                link.script.credit_bytes,
                                                link.script.zstd};
    if (!co_await link.send(welcome)) co_return false;
    for (const auto& correction : link.script.corrections) {
        const wire::Message message = correction;
        if (!co_await link.send(message)) co_return false;
    }
    co_return true;
}

asio::awaitable<bool> FakeServer::meet(Link& link, const wire::PlanRequest& request) {
    plans_.push_back(request);
    if (link.script.hang_up_after_requests == ++link.requests) co_return false;
    const wire::Path path{{Point2{0.0, 0.0}, request.goal}, norm(request.goal), norm(request.goal)};
    const wire::Message reply = wire::PlanReply{request.id, 1, path};
    co_return co_await link.send(reply);
}

asio::awaitable<bool> FakeServer::meet(Link& link, const wire::LocateRequest& request) {
    locates_.push_back(request);
    if (link.script.hang_up_after_requests == ++link.requests) co_return false;
    if (!link.script.knows_locating) {
        const wire::Message error = wire::LinkError{
            {Errc::kMalformed, "a frame without a body this program knows; it may come from a newer version"}, false};
        co_await link.send(error);
        co_return false;
    }
    const auto& first = link.script.locations;
    const std::size_t asked = locates_.size();
    const wire::Message reply =
        wire::LocateReply{request.id, stored_.size(), asked <= first.size() ? first[asked - 1] : link.script.location};
    co_return co_await link.send(reply);
}

asio::awaitable<bool> FakeServer::take(Link& link, const wire::ScanBatch& batch, std::size_t frame_bytes) {
    const LinkScript& script = link.script;
    ++batches_;
    largest_batch_ = std::max(largest_batch_, batch.scans.size());
    link.unacknowledged_bytes += frame_bytes;
    if (link.unacknowledged_bytes > script.credit_bytes) {
        faults_.push_back(
            fmt::format("{} bytes in flight, {} granted", link.unacknowledged_bytes, script.credit_bytes));
    }
    for (const Scan& scan : batch.scans) {
        if (!link.sensors.contains(scan.sensor)) faults_.push_back("a scan of a sensor that was not described");
        if (scan.seq != stored_.size() + 1) {
            faults_.push_back(fmt::format("scan {} after scan {}", scan.seq, stored_.size()));
        }
        stored_.push_back(scan);
        ++link.scans;
        on_stored(stored_.size());
        if (script.hang_up_after_scans == link.scans) {
            if (script.error_after_scans) {
                const wire::Message error = *script.error_after_scans;
                co_await link.send(error);
            }
            co_return false;
        }
        if (script.silent_after_scans == link.scans) link.is_silent = true;
        if (script.stop_reading_after_scans == link.scans) {
            asio::steady_timer never(io_, asio::steady_timer::time_point::max());
            co_await never.async_wait(kAwaitTuple);
        }
    }
    if (++link.batches % script.ack_every != 0 || link.is_silent) co_return true;
    durable_ = stored_.size();
    link.unacknowledged_bytes = 0;
    const wire::Message ack = wire::Ack{durable_, durable_, script.credit_bytes};
    co_return co_await link.send(ack);
}

} // namespace scanloom::robot
