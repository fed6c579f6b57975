#pragma once

#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace scanloom::testing_support {

/// Returns a message as a frame, with the length prefix.
inline std::string frame_of(const wire::Message& message) {
    std::string frame;
    wire::encode(message, frame);
    return frame;
}

/// A robot that sends given bytes, valid or not, and waits for whole frames. It does not implement the protocol. Throws
/// if the connection is reset, so that a lost answer is not mistaken for an orderly close.
class RobotSocket {
public:
    explicit RobotSocket(std::uint16_t port) {
        socket_.connect({boost::asio::ip::address_v4::loopback(), port});
        socket_.set_option(boost::asio::ip::tcp::no_delay(true));
    }

    void send_bytes(std::string_view bytes) { boost::asio::write(socket_, boost::asio::buffer(bytes)); }
    void send(const wire::Message& message) { send_bytes(frame_of(message)); }

    /// Waits for the next message. @return nullopt if the server closed the connection in order
    std::optional<wire::Message> receive() {
        for (;;) {
            if (const auto body = decoder_.next().value()) return wire::decode(*body).value();
            const auto room = decoder_.prepare(4096);
            boost::system::error_code error;
            const auto bytes = socket_.read_some(boost::asio::buffer(room.data(), room.size()), error);
            if (error == boost::asio::error::eof) return std::nullopt;
            if (error) throw boost::system::system_error(error, "reading from the server");
            decoder_.commit(bytes);
        }
    }

    /// Waits for the next message of this kind; skips acknowledgements and corrections.
    template <class Kind>
    Kind receive_kind() {
        for (;;) {
            const auto message = receive();
            if (!message) throw std::runtime_error("the server hung up instead of answering");
            if (const auto* wanted = std::get_if<Kind>(&*message)) return *wanted;
            if (const auto* error = std::get_if<wire::LinkError>(&*message)) {
                throw std::runtime_error("the server answered: " + error->error.message);
            }
            if (!std::holds_alternative<wire::Ack>(*message) && !std::holds_alternative<wire::Correction>(*message)) {
                throw std::runtime_error("the server sent a " + std::string(wire::name_of(*message)));
            }
        }
    }

    /// Waits until every scan up to `seq` is acknowledged.
    void wait_for_ack(std::uint64_t seq) {
        while (receive_kind<wire::Ack>().durable_seq < seq) {
        }
    }

    void finish_sending() { socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_send); }

    /// Closes the connection with a reset, as when the power fails behind a router.
    void reset() {
        socket_.set_option(boost::asio::socket_base::linger(true, 0));
        socket_.close();
    }

private:
    boost::asio::io_context io_;
    boost::asio::ip::tcp::socket socket_{io_};
    wire::FrameDecoder decoder_{wire::kFrameBytesMax};
};

} // namespace scanloom::testing_support
