#pragma once

#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace boost::asio::ssl {
class context;
}

namespace scanloom::testing_support {

/// A message that a client has published.
struct PublishedMessage {
    std::string topic;
    std::string encoding;
    std::string type;
    std::string payload;
};

/// A bridge of the Foxglove WebSocket protocol on a free port of 127.0.0.1, in the test's io_context, written apart
/// from the client. It sends what the test states, and remembers what clients do.
/// Threads: that of the io_context.
class FakeBridge {
public:
    struct Options {
        std::string subprotocol = "foxglove.sdk.v1"; ///< that it accepts; empty: it accepts without one
        int refusal = 0;                             ///< HTTP status of its answer to a handshake; 0: it accepts
        std::string greeting = R"({"op":"serverInfo","name":"fake","capabilities":["clientPublish"],)"
                               R"("supportedEncodings":["ros1"]})";
        bool is_deaf = false;                     ///< it reads nothing, so that it answers no ping
        std::uint16_t port = 0;                   ///< 0: any free one
        boost::asio::ssl::context* tls = nullptr; ///< for wss
    };

    FakeBridge(boost::asio::io_context& io, Options options);
    explicit FakeBridge(boost::asio::io_context& io) : FakeBridge(io, Options{}) {}
    ~FakeBridge();
    FakeBridge(const FakeBridge&) = delete;
    FakeBridge& operator=(const FakeBridge&) = delete;

    [[nodiscard]] std::uint16_t port() const;

    /// Offers a topic, now and to later clients. Ids are never used again.
    /// @return id of its channel
    std::uint64_t advertise(const std::string& topic, const std::string& encoding, const std::string& type);
    /// Withdraws a channel.
    void unadvertise(std::uint64_t channel);
    /// Sends a message to the clients that have subscribed to a channel. @return whether there is one
    bool send(std::uint64_t channel, std::int64_t log_time, const std::string& payload);
    /// Sends a text frame to all clients.
    void send_text(const std::string& text);
    /// Sends a binary frame to all clients.
    void send_binary(const std::string& bytes);
    /// Closes all connections; new ones are accepted.
    void drop_clients();

    /// Returns whether a client has subscribed to a channel.
    [[nodiscard]] bool is_subscribed(std::uint64_t channel) const;
    /// Returns the sub-protocols that the last client offered.
    [[nodiscard]] const std::string& offered() const;
    /// Returns the number of clients that have connected so far.
    [[nodiscard]] std::size_t connections() const;
    [[nodiscard]] const std::vector<PublishedMessage>& published() const;

    std::function<void()> on_change = [] {}; ///< a client has connected, subscribed, unsubscribed or published

private:
    class State;
    std::shared_ptr<State> state_; // shared with coroutines of the io_context
};

} // namespace scanloom::testing_support
