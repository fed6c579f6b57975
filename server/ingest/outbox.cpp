#include "server/ingest/outbox.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include <utility>

namespace scanloom::ingest {
namespace asio = boost::asio;

Outbox::Outbox(net::LinkStream& stream, std::function<void(std::uint64_t)> told)
    : stream_(stream), told_(std::move(told)), emptied_(stream.get_executor()) {
    emptied_.expires_at(std::chrono::steady_clock::time_point::max());
}

void Outbox::send(const wire::Message& message, std::shared_ptr<void> owner) {
    if (closed_) return;
    put_ack(); // what was acknowledged first is told first
    wire::encode(message, bytes_);
    start(std::move(owner));
}

void Outbox::send_bytes(std::string_view bytes, std::shared_ptr<void> owner) {
    if (closed_) return;
    bytes_ += bytes;
    start(std::move(owner));
}

void Outbox::acknowledge(const wire::Ack& ack, std::shared_ptr<void> owner) {
    if (closed_) return;
    ack_ = ack;
    start(std::move(owner));
}

void Outbox::answer(std::string frame, std::shared_ptr<const void> kept, std::shared_ptr<void> owner) {
    if (closed_) return;
    answers_.push_back({std::move(frame), std::move(kept)});
    start(std::move(owner));
}

void Outbox::put_ack() {
    if (!ack_) return;
    durable_seq_ = ack_->durable_seq;
    wire::encode(*std::exchange(ack_, std::nullopt), bytes_);
}

std::string Outbox::take_bytes() {
    if (durable_seq_) told_(*std::exchange(durable_seq_, std::nullopt));
    return std::exchange(bytes_, {});
}

Outbox::Answer Outbox::take_answer() {
    Answer first = std::move(answers_.front());
    answers_.pop_front();
    return first;
}

void Outbox::start(std::shared_ptr<void> owner) {
    if (std::exchange(writing_, true)) return;
    asio::co_spawn(stream_.get_executor(), write(std::move(owner)), asio::detached);
}

/// Writes until nothing is left. Acks that come meanwhile collapse into the newest.
asio::awaitable<void> Outbox::write([[maybe_unused]] std::shared_ptr<void> owner) {
    while (ack_ || !bytes_.empty() || !answers_.empty()) {
        put_ack();
        const Answer next = bytes_.empty() ? take_answer() : Answer{take_bytes(), nullptr};
        const auto [error, written] =
            co_await asio::async_write(stream_, asio::buffer(next.frame), asio::as_tuple(asio::use_awaitable));
        if (error) break;
    }
    writing_ = false;
    emptied_.cancel();
}

asio::awaitable<void> Outbox::emptied() {
    if (writing_) co_await emptied_.async_wait(asio::as_tuple(asio::use_awaitable));
}

} // namespace scanloom::ingest
