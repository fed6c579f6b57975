#include "tests/support/fake_bridge.hpp"

#include "common/net/await_tuple.hpp"
#include "common/net/web_socket.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <array>
#include <deque>
#include <utility>

namespace scanloom::testing_support {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;

namespace {

constexpr auto kNever = asio::steady_timer::time_point::max();

/// A client. It lives as long as its coroutine.
struct BridgeClient {
    BridgeClient(tcp::socket socket, asio::ssl::context* tls)
        : stream(tls != nullptr ? net::LinkStream(std::move(socket), *tls) : net::LinkStream(std::move(socket))) {}

    net::WebSocket stream;
    bool is_open = false;
    std::map<std::uint64_t, std::uint32_t> subscriptions; // by channel
    std::map<std::uint64_t, PublishedMessage> channels;   // that it publishes on
    std::deque<std::pair<std::string, bool>> unsent;      // and whether it is binary
    bool is_writing = false;
};

void append_bytes(std::string& bytes, std::uint64_t value, int count) {
    for (int n = 0; n < count; ++n) bytes += static_cast<char>(value >> (8 * n));
}

} // namespace

class FakeBridge::State : public std::enable_shared_from_this<State> {
public:
    State(asio::io_context& io, Options options, const FakeBridge& owner)
        : options_(std::move(options)), owner_(&owner),
          acceptor_(io, {asio::ip::address_v4::loopback(), options_.port}) {}

    void start() { asio::co_spawn(acceptor_.get_executor(), accept(shared_from_this()), asio::detached); }

    void stop() {
        owner_ = nullptr;
        boost::system::error_code ignored;
        acceptor_.close(ignored);
        drop_clients();
    }

    void drop_clients() {
        for (const auto& client : clients_) client->stream.next_layer().close();
    }

    void send(const std::shared_ptr<BridgeClient>& client, std::string frame, bool is_binary) {
        client->unsent.emplace_back(std::move(frame), is_binary);
        if (client->is_open && !std::exchange(client->is_writing, true)) {
            asio::co_spawn(acceptor_.get_executor(), write(client), asio::detached);
        }
    }

    void send_to_all(const std::string& frame, bool is_binary) {
        for (const auto& client : clients_) send(client, frame, is_binary);
    }

    static std::string advertisement(const std::string& channels) {
        return fmt::format(R"({{"op":"advertise","channels":[{}]}})", channels);
    }

    Options options_;
    const FakeBridge* owner_; // null after its end
    tcp::acceptor acceptor_;
    std::vector<std::shared_ptr<BridgeClient>> clients_;
    std::map<std::uint64_t, std::string> channels_; // their JSON
    std::uint64_t next_channel_ = 1;
    std::string offered_;
    std::size_t connections_ = 0;
    std::vector<PublishedMessage> published_;

private:
    void changed() const {
        if (owner_ == nullptr) return;
        const auto notify = owner_->on_change; // which may replace itself
        notify();
    }

    static asio::awaitable<void> accept(std::shared_ptr<State> self) {
        for (;;) {
            tcp::socket socket(self->acceptor_.get_executor());
            const auto [failed] = co_await self->acceptor_.async_accept(socket, kAwaitTuple);
            if (failed) co_return;
            auto client = std::make_shared<BridgeClient>(std::move(socket), self->options_.tls);
            asio::co_spawn(self->acceptor_.get_executor(), serve(self, client), asio::detached);
        }
    }

    static asio::awaitable<void> serve(std::shared_ptr<State> self, std::shared_ptr<BridgeClient> client) {
        auto& stream = client->stream;
        if (std::get<0>(co_await stream.next_layer().async_handshake(net::LinkStream::Role::kServer, kAwaitTuple))) {
            co_return;
        }
        beast::flat_buffer buffer;
        beast::http::request<beast::http::string_body> request;
        const auto [unread, size] = co_await beast::http::async_read(stream.next_layer(), buffer, request, kAwaitTuple);
        if (unread) co_return;
        self->offered_ = std::string(request[beast::http::field::sec_websocket_protocol]);
        if (self->options_.refusal != 0) {
            beast::http::response<beast::http::string_body> answer(
                static_cast<beast::http::status>(self->options_.refusal), 11);
            answer.prepare_payload();
            co_await beast::http::async_write(stream.next_layer(), answer, kAwaitTuple);
            co_return;
        }
        stream.set_option(websocket::stream_base::decorator([name = self->options_.subprotocol](auto& answer) {
            if (!name.empty()) answer.set(beast::http::field::sec_websocket_protocol, name);
        }));
        if (co_await net::accept(stream, request)) co_return;
        client->is_open = true;
        ++self->connections_;
        self->clients_.push_back(client);
        if (!self->options_.greeting.empty()) self->send(client, self->options_.greeting, false);
        for (const auto& [id, channel] : self->channels_)
            self->send(client, advertisement(channel), false); // in pieces
        self->changed();
        if (self->options_.is_deaf) {
            asio::steady_timer never(stream.get_executor(), kNever);
            co_await never.async_wait(kAwaitTuple);
        }
        co_await read(self, client);
        client->is_open = false;
        std::erase(self->clients_, client);
    }

    static asio::awaitable<void> read(std::shared_ptr<State> self, std::shared_ptr<BridgeClient> client) {
        beast::flat_buffer buffer;
        for (;;) {
            buffer.clear();
            if (co_await net::read(client->stream, buffer)) co_return;
            const std::string frame(static_cast<const char*>(buffer.data().data()), buffer.size());
            client->stream.got_binary() ? self->take_message(*client, frame) : take_text(*client, frame);
            self->changed();
        }
    }

    static asio::awaitable<void> write(std::shared_ptr<BridgeClient> client) {
        while (!client->unsent.empty() && client->is_open) {
            const auto [frame, is_binary] = std::move(client->unsent.front());
            client->unsent.pop_front();
            client->stream.binary(is_binary);
            const std::array parts{asio::const_buffer(asio::buffer(frame))};
            if (co_await net::write(client->stream, parts)) break;
        }
        client->is_writing = false;
    }

    static void take_text(BridgeClient& client, const std::string& text) {
        const auto object = boost::json::parse(text).as_object();
        const auto& op = object.at("op").as_string();
        if (op == "subscribe") {
            for (const auto& each : object.at("subscriptions").as_array()) {
                client.subscriptions[each.at("channelId").to_number<std::uint64_t>()] =
                    each.at("id").to_number<std::uint32_t>();
            }
        } else if (op == "unsubscribe") {
            for (const auto& id : object.at("subscriptionIds").as_array()) {
                std::erase_if(client.subscriptions,
                              [&](const auto& one) { return one.second == id.to_number<std::uint32_t>(); });
            }
        } else if (op == "advertise") {
            for (const auto& each : object.at("channels").as_array()) {
                client.channels[each.at("id").to_number<std::uint64_t>()] = {
                    std::string(each.at("topic").as_string()), std::string(each.at("encoding").as_string()),
                    std::string(each.at("schemaName").as_string()), ""};
            }
        }
    }

    void take_message(BridgeClient& client, const std::string& frame) {
        std::uint64_t channel = 0;
        for (std::size_t n = 0; n < 4; ++n)
            channel |= std::uint64_t{static_cast<unsigned char>(frame.at(1 + n))} << (8 * n);
        PublishedMessage message = client.channels.at(channel);
        message.payload = frame.substr(5);
        published_.push_back(std::move(message));
    }
};

FakeBridge::FakeBridge(asio::io_context& io, Options options)
    : state_(std::make_shared<State>(io, std::move(options), *this)) {
    state_->start();
}

FakeBridge::~FakeBridge() { state_->stop(); }

std::uint16_t FakeBridge::port() const { return state_->acceptor_.local_endpoint().port(); }

std::uint64_t FakeBridge::advertise(const std::string& topic, const std::string& encoding, const std::string& type) {
    const auto id = state_->next_channel_++;
    auto& channel = state_->channels_[id];
    channel = fmt::format(R"({{"id":{},"topic":"{}","encoding":"{}","schemaName":"{}","schema":""}})", id, topic,
                          encoding, type);
    state_->send_to_all(State::advertisement(channel), false);
    return id;
}

void FakeBridge::unadvertise(std::uint64_t channel) {
    state_->channels_.erase(channel);
    for (const auto& client : state_->clients_) client->subscriptions.erase(channel);
    state_->send_to_all(fmt::format(R"({{"op":"unadvertise","channelIds":[{}]}})", channel), false);
}

bool FakeBridge::send(std::uint64_t channel, std::int64_t log_time, const std::string& payload) {
    bool is_sent = false;
    for (const auto& client : state_->clients_) {
        const auto subscription = client->subscriptions.find(channel);
        if (subscription == client->subscriptions.end()) continue;
        std::string frame = "\x01";
        append_bytes(frame, subscription->second, 4);
        append_bytes(frame, static_cast<std::uint64_t>(log_time), 8);
        state_->send(client, frame + payload, true);
        is_sent = true;
    }
    return is_sent;
}

void FakeBridge::send_text(const std::string& text) { state_->send_to_all(text, false); }

void FakeBridge::send_binary(const std::string& bytes) { state_->send_to_all(bytes, true); }

void FakeBridge::drop_clients() { state_->drop_clients(); }

bool FakeBridge::is_subscribed(std::uint64_t channel) const {
    for (const auto& client : state_->clients_) {
        if (client->subscriptions.contains(channel)) return true;
    }
    return false;
}

const std::string& FakeBridge::offered() const { return state_->offered_; }

std::size_t FakeBridge::connections() const { return state_->connections_; }

const std::vector<PublishedMessage>& FakeBridge::published() const { return state_->published_; }

} // namespace scanloom::testing_support
