#include "common/link/send_queue.hpp"

#include <utility>

namespace scanloom::link {

void SendQueue::add(const wire::Message& message) {
    if (closed_) return;
    append_ack(); // an ack that came first is sent first
    wire::encode(message, bytes_);
}

void SendQueue::add_bytes(std::string_view bytes) {
    if (!closed_) bytes_ += bytes;
}

void SendQueue::acknowledge(const wire::Ack& ack) {
    if (!closed_) ack_ = ack;
}

void SendQueue::add_reply(std::string frame, std::shared_ptr<const void> kept) {
    if (!closed_) replies_.push_back({std::move(frame), std::move(kept)});
}

void SendQueue::append_ack() {
    if (!ack_) return;
    durable_seq_ = ack_->durable_seq;
    wire::encode(*std::exchange(ack_, std::nullopt), bytes_);
}

std::optional<SendQueue::Piece> SendQueue::next() {
    append_ack();
    if (!bytes_.empty()) return Piece{std::exchange(bytes_, {}), nullptr, std::exchange(durable_seq_, std::nullopt)};
    if (replies_.empty()) return std::nullopt;
    Piece first = std::move(replies_.front());
    replies_.pop_front();
    return first;
}

} // namespace scanloom::link
