#include "server/http/response_writer.hpp"

#include "common/net/await_tuple.hpp"
#include "server/http/api.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/beast/core/buffers_suffix.hpp>
#include <boost/beast/core/error.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

namespace scanloom::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;

constexpr std::size_t kLingerReadBytes = 4096;
constexpr std::size_t kLingerBytesMax = 256 * 1024;

/// Confines a fault of the server to this response.
Result<std::string> next_guarded(BodyStream& stream) {
    try {
        return stream.next();
    } catch (const std::exception& failure) {
        return Error{Errc::kInternal, failure.what()};
    }
}

} // namespace

asio::awaitable<bool> ResponseWriter::write(const Response& response, Manner manner) {
    service_.counters.answered(static_cast<unsigned>(response.status)).Increment();
    const auto [framing, persistence] = transfer_of(response, manner);
    const bool is_kept = persistence != Persistence::kClose;
    const bool is_streamed = response.stream != nullptr;
    const std::string head = head_text(response, persistence, date_now(), framing, stream_.is_encrypted());
    const bool with_body = manner.with_body && !is_streamed;
    bool written = co_await write_all(head, with_body ? response.body.bytes() : std::string_view());
    const bool with_stream = written && manner.with_body && is_streamed;
    if (with_stream) written = co_await write_stream(*response.stream, framing);
    must_linger_ = written && !is_kept;
    const bool can_go_on = written && is_kept;
    co_return can_go_on;
}

asio::awaitable<void> ResponseWriter::write_without_tls(const Response& response) {
    service_.counters.answered(static_cast<unsigned>(response.status)).Increment();
    stream_ = net::LinkStream(std::move(stream_.socket()));
    must_linger_ = co_await write_all(head_text(response, Persistence::kClose, date_now()), response.body.bytes());
}

/// Produces each piece after the previous one is sent, so a slow client occupies one piece of memory.
asio::awaitable<bool> ResponseWriter::write_stream(BodyStream& body, Framing framing) {
    for (;;) {
        const Result<std::string> piece = co_await sockets::compute_on(
            service_.api.services().work_classes.executors().log_export, [&body] { return next_guarded(body); });
        if (!piece) {
            spdlog::error("an answer broke off: {}", piece.error().message);
            co_return false;
        }
        if (framing == Framing::kUntilClosed) {
            if (piece->empty()) co_return true;
            const bool sent = co_await write_all(*piece);
            if (!sent) co_return false;
            continue;
        }
        const std::string chunk = fmt::format("{:x}\r\n{}\r\n", piece->size(), *piece); // an empty one is the last
        const bool sent = co_await write_all(chunk);
        if (!sent || piece->empty()) co_return sent;
    }
}

/// Sends at once what the socket accepts. For the rest, each piece has a deadline, so that a large response may take
/// long while the client reads it. The whole has a deadline too, so that a client cannot keep a response in memory by
/// reading single bytes.
asio::awaitable<bool> ResponseWriter::write_all(std::string_view head, std::string_view body) {
    const std::array<asio::const_buffer, 2> whole = {asio::buffer(head), asio::buffer(body)};
    beast::buffers_suffix<std::array<asio::const_buffer, 2>> rest(whole);
    beast::error_code failed;
    rest.consume(stream_.try_write(whole, failed));
    if (failed && failed != asio::error::would_block) co_return false;
    if (beast::buffer_bytes(rest) == 0) co_return true;
    const auto& config = service_.config;
    const auto size_seconds =
        static_cast<double>(head.size() + body.size()) / static_cast<double>(config.write_rate_min);
    const auto end = std::chrono::steady_clock::now() + config.write +
                     std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(size_seconds));
    wait_.begin(PeerWait::Clock::now());
    const auto bytes = static_cast<double>(beast::buffer_bytes(rest));
    while (beast::buffer_bytes(rest) > 0) {
        const auto taken = bytes - static_cast<double>(beast::buffer_bytes(rest));
        wait_.allow(taken / static_cast<double>(config.write_rate_min));
        deadline_.set(std::min(end, std::chrono::steady_clock::now() + config.write));
        const auto [error, size] = co_await stream_.async_write_some(rest, kAwaitTuple);
        deadline_.clear();
        if (error) co_return false;
        rest.consume(size);
    }
    wait_.end();
    co_return true;
}

/// Closing a socket with unread bytes resets it, and a peer that is still sending would never see the response.
/// Therefore this shuts down the sending side and continues to read for a while.
asio::awaitable<void> ResponseWriter::finish() {
    if (!must_linger_) co_return;
    deadline_.set_after(service_.config.linger);
    co_await stream_.async_farewell(kAwaitTuple);
    stream_.shutdown_send();
    std::array<char, kLingerReadBytes> rubbish;
    for (std::size_t total = 0; total < kLingerBytesMax;) {
        const auto [error, size] = co_await stream_.socket().async_read_some(asio::buffer(rubbish), kAwaitTuple);
        if (error) break;
        total += size;
    }
}

} // namespace scanloom::http
