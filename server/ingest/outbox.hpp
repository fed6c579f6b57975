#pragma once

#include "common/net/link_stream.hpp"
#include "common/wire/messages.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::ingest {

/// What a link still has to write to its robot, in order; of acks only the newest. Answers to requests, which may be
/// long, come one by one when nothing else waits.
///
/// Queue   "link's outbox": pongs and refusals, which whoever reads bounds by waiting(); answers, by
///         answers_waiting(); and one ack.
/// Thread  the socket's executor, a strand.
class Outbox {
public:
    /// `socket` must outlive this. `owner` keeps both alive while something is being written.
    /// `told` is called with the durable_seq of each ack that is handed to the socket.
    Outbox(net::LinkStream& stream, std::function<void(std::uint64_t)> told);

    void send(const wire::Message& message, std::shared_ptr<void> owner);
    void send_bytes(std::string_view bytes, std::shared_ptr<void> owner);

    /// Replaces an ack that was not written yet.
    void acknowledge(const wire::Ack& ack, std::shared_ptr<void> owner);

    /// Sends a whole frame after all else. `kept` is let go of when it was written.
    void answer(std::string frame, std::shared_ptr<const void> kept, std::shared_ptr<void> owner);

    /// Answers that are not being written yet. The one being written is not among them: the robot may have read the
    /// whole of it, and ask the next, before this side hears that it was written.
    [[nodiscard]] std::size_t answers_waiting() const noexcept { return answers_.size(); }

    /// Nothing may follow what is in it.
    void close() { closed_ = true; }

    /// Bytes that are not being written yet.
    [[nodiscard]] std::size_t waiting() const noexcept { return bytes_.size(); }

    /// Returns when all is written, or the connection has failed.
    [[nodiscard]] boost::asio::awaitable<void> emptied();

private:
    struct Answer {
        std::string frame;
        std::shared_ptr<const void> kept;
    };

    void put_ack();
    [[nodiscard]] std::string take_bytes();
    [[nodiscard]] Answer take_answer();
    void start(std::shared_ptr<void> owner);
    [[nodiscard]] boost::asio::awaitable<void> write(std::shared_ptr<void> owner);

    net::LinkStream& stream_;
    std::function<void(std::uint64_t)> told_;
    std::string bytes_;
    std::deque<Answer> answers_;
    std::optional<wire::Ack> ack_;             // the newest, not in bytes_ yet
    std::optional<std::uint64_t> durable_seq_; // of the newest ack in bytes_
    bool writing_ = false;
    bool closed_ = false;
    boost::asio::steady_timer emptied_; // never runs out; cancelled when there is nothing left
};

} // namespace scanloom::ingest
