#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::testing_support {

/// A blocking viewer that reads only when a test calls read().
class LiveClient {
public:
    /// @param receive_bytes  size of the socket's receive buffer; 0: the system's default
    explicit LiveClient(std::uint16_t port, const std::string& session = "lab", int receive_bytes = 0) {
        auto& socket = stream_.next_layer();
        socket.open(boost::asio::ip::tcp::v4());
        if (receive_bytes > 0) socket.set_option(boost::asio::socket_base::receive_buffer_size(receive_bytes));
        socket.connect({boost::asio::ip::address_v4::loopback(), port});
        stream_.handshake("127.0.0.1", fmt::format("/api/v1/sessions/{}/live", session));
        stream_.binary(true);
    }

    /// Returns the next message, or nullopt at the end of the connection. code() and reason() then give the cause.
    [[nodiscard]] std::optional<std::string> read() {
        boost::beast::flat_buffer buffer;
        boost::system::error_code failed;
        stream_.read(buffer, failed);
        if (failed) return std::nullopt;
        is_binary_ = stream_.got_binary();
        return std::string(static_cast<const char*>(buffer.data().data()), buffer.size());
    }

    /// Reads until the connection ends. @return the number of messages
    std::size_t read_to_the_end() {
        std::size_t count = 0;
        while (read()) ++count;
        return count;
    }

    void send(std::string_view message, bool binary = true) {
        boost::system::error_code ignored;
        stream_.binary(binary);
        stream_.write(boost::asio::buffer(message.data(), message.size()), ignored);
    }

    /// Sends bytes that are not a valid client frame.
    void send_raw(std::string_view bytes) {
        boost::system::error_code ignored;
        boost::asio::write(stream_.next_layer(), boost::asio::buffer(bytes.data(), bytes.size()), ignored);
    }

    /// Returns the close code that the server sent; 0: none.
    [[nodiscard]] unsigned code() const { return stream_.reason().code; }
    [[nodiscard]] std::string reason() const { return stream_.reason().reason.c_str(); }
    [[nodiscard]] bool is_binary() const { return is_binary_; }

private:
    boost::asio::io_context io_;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> stream_{io_};
    bool is_binary_ = false;
};

} // namespace scanloom::testing_support
