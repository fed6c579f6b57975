#include "server/ingest/outbox.hpp"

#include <utility>

namespace scanloom::ingest {

void Outbox::send(const wire::Message& message) {
    if (closed_) return;
    put_ack(); // an ack that came first is sent first
    wire::encode(message, bytes_);
    added_();
}

void Outbox::send_bytes(std::string_view bytes) {
    if (closed_) return;
    bytes_ += bytes;
    added_();
}

void Outbox::acknowledge(const wire::Ack& ack) {
    if (closed_) return;
    ack_ = ack;
    added_();
}

void Outbox::answer(std::string frame, std::shared_ptr<const void> kept) {
    if (closed_) return;
    answers_.push_back({std::move(frame), std::move(kept)});
    added_();
}

void Outbox::put_ack() {
    if (!ack_) return;
    durable_seq_ = ack_->durable_seq;
    wire::encode(*std::exchange(ack_, std::nullopt), bytes_);
}

std::optional<Outbox::Piece> Outbox::next() {
    put_ack();
    if (!bytes_.empty()) return Piece{std::exchange(bytes_, {}), nullptr, std::exchange(durable_seq_, std::nullopt)};
    if (answers_.empty()) return std::nullopt;
    Piece first = std::move(answers_.front());
    answers_.pop_front();
    return first;
}

} // namespace scanloom::ingest
