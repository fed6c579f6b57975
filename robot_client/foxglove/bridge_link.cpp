#include "robot_client/foxglove/bridge_link.hpp"

#include "common/net/await_tuple.hpp"
#include "common/net/connect.hpp"
#include "common/net/web_socket.hpp"
#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>
#include <variant>

namespace scanloom::robot {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using namespace asio::experimental::awaitable_operators;

namespace {

using Clock = std::chrono::steady_clock;
using Stream = net::WebSocket;
using boost::system::error_code;

constexpr auto kProtocolField = beast::http::field::sec_websocket_protocol;

class BridgeReading {
public:
    BridgeReading(BridgeLinkOptions& options, BridgeListener& listener, WakeSignal& to_send)
        : options_(options), listener_(listener), to_send_(to_send), backoff_(options.backoff_seed, options.backoff) {}

    asio::awaitable<Error> run();

private:
    [[nodiscard]] asio::awaitable<Error> use_one_connection();
    [[nodiscard]] asio::awaitable<Result<>> shake_hands(Stream& stream) const;
    [[nodiscard]] asio::awaitable<Error> read_frames(Stream& stream);
    [[nodiscard]] asio::awaitable<Error> write_frames(Stream& stream);
    [[nodiscard]] asio::awaitable<Error> watch(Stream& stream);
    void on_connected();
    [[nodiscard]] bool give_up(const Error& error);
    [[nodiscard]] Error other_protocol(const std::string& what) const;
    [[nodiscard]] Error ended(Stream& stream, const error_code& failed) const;

    BridgeLinkOptions& options_;
    BridgeListener& listener_;
    WakeSignal& to_send_;
    Backoff backoff_;
    bool was_connected_ = false;
    std::optional<Clock::time_point> connected_since_; // the connection that is open or was the last one
    std::optional<Clock::time_point> gone_since_;
    bool is_return_noted_ = false; // since it is gone
};

asio::awaitable<bool> is_cancelled() {
    co_return (co_await asio::this_coro::cancellation_state).cancelled() != asio::cancellation_type::none;
}

asio::awaitable<Error> BridgeReading::run() {
    co_await asio::this_coro::throw_if_cancelled(false);
    for (;;) {
        const Error error = co_await use_one_connection();
        if (co_await is_cancelled()) co_return Error{Errc::kShuttingDown, "reading the bridge was stopped"};
        if (give_up(error)) {
            const bool was_tried = options_.reopen_for.count() > 0 && error.code != Errc::kUnsupportedVersion;
            co_return was_tried
                ? Error{error.code, fmt::format("{} (retried for {:g} s)", error.message, seconds(options_.reopen_for))}
                : error;
        }
        asio::steady_timer timer(co_await asio::this_coro::executor, backoff_.next());
        co_await timer.async_wait(kAwaitTuple);
    }
}

bool BridgeReading::give_up(const Error& error) {
    if (error.code == Errc::kUnsupportedVersion && !was_connected_) return true;
    const auto connected_since = std::exchange(connected_since_, std::nullopt);
    if (connected_since && Clock::now() - *connected_since >= options_.steady_after) {
        gone_since_.reset();
        backoff_.reset();
    }
    if (!gone_since_) {
        gone_since_ = Clock::now();
        is_return_noted_ = false;
        if (options_.reopen_for.count() > 0) {
            options_.note(further(error.message, fmt::format("retrying for {:g} s", seconds(options_.reopen_for))));
        }
    }
    return Clock::now() - *gone_since_ >= options_.reopen_for;
}

/// Connects and exchanges frames until the connection fails.
asio::awaitable<Error> BridgeReading::use_one_connection() {
    const auto executor = co_await asio::this_coro::executor;
    Stream stream(net::client_stream(executor, options_.tls));
    const auto reached = co_await net::connect(stream.next_layer(), options_.bridge.address, options_.answer_max,
                                               {"the URL", "foxglove_bridge"});
    if (!reached) co_return reached.error();
    const auto shaken = co_await shake_hands(stream);
    if (!shaken) co_return shaken.error();
    listener_.on_open();
    const auto first = co_await (read_frames(stream) || write_frames(stream) || watch(stream));
    listener_.on_lost();
    co_return std::visit([](const Error& error) { return error; }, first);
}

asio::awaitable<Result<>> BridgeReading::shake_hands(Stream& stream) const {
    stream.set_option(websocket::stream_base::timeout{options_.answer_max, options_.silent_max, true});
    stream.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
        request.set(kProtocolField, beast::string_view(foxglove::kSubprotocols.data(), foxglove::kSubprotocols.size()));
    }));
    stream.read_message_max(kBridgeFrameMax);
    websocket::response_type answer;
    const std::string host = options_.bridge.address.text();
    const auto failed = co_await net::shake_hands(stream, answer, host, options_.bridge.target);
    if (failed == websocket::error::upgrade_declined && answer.result_int() >= 500) {
        co_return Error{Errc::kUnreachable, fmt::format("{} answers the WebSocket handshake with {}; is the bridge "
                                                        "behind this proxy running?",
                                                        options_.bridge.text, answer.result_int())};
    }
    if (failed == websocket::error::upgrade_declined) {
        co_return other_protocol(fmt::format("answers the WebSocket handshake with {}", answer.result_int()));
    }
    if (failed == beast::error::timeout || failed == asio::error::operation_aborted) {
        co_return Error{Errc::kTimeout, fmt::format("{} did not answer the WebSocket handshake within {:g} s",
                                                    options_.bridge.text, seconds(options_.answer_max))};
    }
    const bool is_of_network = failed.category() == boost::system::system_category() ||
                               failed.category() == asio::error::get_misc_category() ||
                               failed == beast::http::error::end_of_stream;
    if (failed && is_of_network) co_return ended(stream, failed);
    if (failed) co_return other_protocol(fmt::format("does not answer as a WebSocket ({})", failed.message()));
    const auto name = answer[kProtocolField];
    const std::string_view chosen(name.data(), name.size());
    const bool is_offered = !chosen.empty() && chosen.find(',') == std::string_view::npos &&
                            foxglove::kSubprotocols.find(chosen) != std::string_view::npos;
    if (!is_offered) co_return other_protocol("accepts none of the sub-protocols");
    co_return Result<>();
}

Error BridgeReading::other_protocol(const std::string& what) const {
    return {Errc::kUnsupportedVersion,
            fmt::format("{} {}: it speaks neither of {}; name a foxglove_bridge, usually at port 8765 (rosbridge, at "
                        "9090, is another protocol)",
                        options_.bridge.text, what, foxglove::kSubprotocols)};
}

Error BridgeReading::ended(Stream& stream, const error_code& failed) const {
    if (failed == beast::error::timeout) {
        return {Errc::kTimeout, fmt::format("{} has not answered for {:g} s; check the network", options_.bridge.text,
                                            seconds(options_.silent_max))};
    }
    if (failed == websocket::error::message_too_big || failed == websocket::error::buffer_overflow) {
        return {Errc::kUnreachable, fmt::format("{} sent a frame of more than {} MiB, and was disconnected",
                                                options_.bridge.text, kBridgeFrameMax >> 20U)};
    }
    if (failed == websocket::error::closed) {
        const auto& reason = stream.reason();
        const std::string text = shown_word(std::string_view(reason.reason.data(), reason.reason.size()));
        return {Errc::kUnreachable, fmt::format("{} has closed the connection with code {}{}{}", options_.bridge.text,
                                                static_cast<unsigned>(reason.code), text.empty() ? "" : ": ", text)};
    }
    const bool is_closed = failed == asio::error::eof || failed == beast::http::error::end_of_stream ||
                           failed == asio::error::connection_reset;
    const std::string why = is_closed ? "has closed the connection" : "cannot be read";
    const auto text =
        is_closed ? std::string("is the bridge running?") : net::failure_text(stream.next_layer(), failed);
    return {Errc::kUnreachable, fmt::format("{} {} ({})", options_.bridge.text, why, text)};
}

asio::awaitable<Error> BridgeReading::read_frames(Stream& stream) {
    beast::flat_buffer buffer;
    for (;;) {
        buffer.clear();
        if (const auto failed = co_await net::read(stream, buffer)) co_return ended(stream, failed);
        const std::string_view frame(static_cast<const char*>(buffer.data().data()), buffer.size());
        const bool was_connected = listener_.is_connected();
        if (stream.got_binary()) {
            listener_.on_binary(frame);
        } else {
            listener_.on_text(frame);
        }
        if (!was_connected && listener_.is_connected()) on_connected();
    }
}

void BridgeReading::on_connected() {
    if (gone_since_ && !std::exchange(is_return_noted_, true)) {
        options_.note(fmt::format("{}: connected{}", options_.bridge.text, was_connected_ ? " again" : ""));
    }
    connected_since_ = Clock::now();
    was_connected_ = true;
    to_send_.notify();
}

asio::awaitable<Error> BridgeReading::write_frames(Stream& stream) {
    for (;;) {
        const auto frame = listener_.is_connected() ? listener_.next_frame() : std::nullopt;
        if (!frame) {
            co_await to_send_.wait();
            continue;
        }
        stream.binary(frame->is_binary);
        const std::array parts{asio::const_buffer(asio::buffer(frame->bytes))};
        if (const auto failed = co_await net::write(stream, parts)) co_return ended(stream, failed);
    }
}

/// Ends if the bridge does not say what it is.
asio::awaitable<Error> BridgeReading::watch(Stream& stream) {
    asio::steady_timer timer(stream.get_executor(), options_.info_max);
    co_await timer.async_wait(kAwaitTuple);
    if (!listener_.is_connected()) {
        co_return other_protocol(fmt::format("sends no serverInfo within {:g} s", seconds(options_.info_max)));
    }
    timer.expires_at(Clock::time_point::max());
    co_await timer.async_wait(kAwaitTuple);
    co_return Error{Errc::kShuttingDown, "cancelled"};
}

} // namespace

asio::awaitable<Error> read_bridge(BridgeLinkOptions options, BridgeListener& listener, WakeSignal& to_send) {
    co_return co_await BridgeReading(options, listener, to_send).run();
}

} // namespace scanloom::robot
