#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <sys/socket.h>
#include <sys/time.h>

#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace scanloom::testing_support {

/// An HTTP response, parsed without the code under test.
struct HttpAnswer {
    int status = 0; ///< 0: the connection ended before the response was complete
    std::map<std::string, std::string> fields;
    std::string body;
};

/// A blocking connection that sends arbitrary bytes. Each wait is limited to 30 s, so that a server that hangs fails
/// one test and does not stop the test run.
class HttpClient {
public:
    explicit HttpClient(std::uint16_t port) : socket_(io_) {
        socket_.connect({boost::asio::ip::address_v4::loopback(), port});
        const timeval deadline{.tv_sec = 30, .tv_usec = 0};
        ::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &deadline, sizeof(deadline));
        ::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_SNDTIMEO, &deadline, sizeof(deadline));
    }
    virtual ~HttpClient() = default;
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    /// Sends bytes and ignores failures, as the server may close the connection at any time.
    void send(std::string_view bytes) {
        while (!bytes.empty()) {
            const auto sent = put(bytes);
            if (sent <= 0) return;
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        }
    }

    /// Reads one response. Pre: for HEAD, `with_body` is false.
    [[nodiscard]] HttpAnswer read(bool with_body = true) {
        HttpAnswer answer;
        std::size_t end = 0;
        while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
            if (!receive()) return answer;
        }
        answer.fields = fields_of(std::string_view(buffer_).substr(0, end));
        const int status = std::stoi(buffer_.substr(9, 3));
        buffer_.erase(0, end + 4);
        const auto length = answer.fields.find("content-length");
        const std::size_t size = with_body && length != answer.fields.end() ? std::stoul(length->second) : 0;
        while (buffer_.size() < size) {
            if (!receive()) return answer;
        }
        answer.body = buffer_.substr(0, size);
        buffer_.erase(0, size);
        answer.status = status;
        return answer;
    }

    /// Returns whether the server closed the connection without sending more bytes. False if it only sends nothing.
    [[nodiscard]] bool is_closed() { return buffer_.empty() && !receive() && !timed_out_; }

    /// Returns whether the server ended the stream in order. A reset could discard a response.
    [[nodiscard]] bool ends_in_order() {
        while (receive()) {
        }
        return last_size_ == 0;
    }

    /// Reads until the stream ends and returns all bytes.
    [[nodiscard]] std::string read_all() {
        while (receive()) {
        }
        return buffer_;
    }

    /// Reads a few bytes at a time until the stream ends, at about 10 MB/s. @return the number of bytes
    [[nodiscard]] std::size_t read_slowly() {
        std::size_t count = 0;
        char bytes[16];
        for (ssize_t size = 0; (size = take(bytes, sizeof(bytes))) > 0;) {
            count += static_cast<std::size_t>(size);
        }
        return count;
    }

    void shutdown_send() { ::shutdown(socket_.native_handle(), SHUT_WR); }

protected:
    /// Same results as send(2) and recv(2).
    virtual ssize_t put(std::string_view bytes) {
        return ::send(socket_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
    virtual ssize_t take(char* into, std::size_t size) { return ::recv(socket_.native_handle(), into, size, 0); }

    [[nodiscard]] int descriptor() { return socket_.native_handle(); }

private:
    /// @return false at the end of the stream.
    bool receive() {
        char bytes[4096];
        const auto size = take(bytes, sizeof(bytes));
        last_size_ = size;
        timed_out_ = size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
        if (size <= 0) return false;
        buffer_.append(bytes, static_cast<std::size_t>(size));
        return true;
    }

    static std::map<std::string, std::string> fields_of(std::string_view head) {
        std::map<std::string, std::string> fields;
        for (auto line = head.find("\r\n"); line != std::string_view::npos; line = head.find("\r\n", line + 2)) {
            const auto colon = head.find(": ", line);
            std::string name(head.substr(line + 2, colon - line - 2));
            for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            fields[name] = head.substr(colon + 2, head.find("\r\n", colon) - colon - 2);
        }
        return fields;
    }

    boost::asio::io_context io_;
    boost::asio::ip::tcp::socket socket_;
    std::string buffer_;
    ssize_t last_size_ = 0;
    bool timed_out_ = false;
};

} // namespace scanloom::testing_support
