#pragma once

#include "common/error/error.hpp"

#include <boost/beast/http/status.hpp>
#include <boost/json/value.hpp>

#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::live {
struct ViewedSession;
}

namespace scanloom::http {

using Status = boost::beast::http::status;

inline constexpr std::string_view kJson = "application/json";
inline constexpr std::string_view kGeoJson = "application/geo+json";

/// May be cached, but must be revalidated with If-None-Match.
inline constexpr std::string_view kRevalidate = "no-cache";
/// Changes with every scan and has no version.
inline constexpr std::string_view kNotKept = "no-store";
/// Never changes at this URL.
inline constexpr std::string_view kImmutable = "public, max-age=31536000, immutable";

/// The bytes of a response with shared ownership: responses with equal content share one copy.
class Body {
public:
    Body() = default;
    explicit Body(std::string text) : Body(std::make_shared<const std::string>(std::move(text))) {}

    /// Refers to a string or a vector of bytes.
    template <class Container>
    explicit Body(std::shared_ptr<const Container> bytes)
        : bytes_(reinterpret_cast<const char*>(bytes->data()), bytes->size()), owner_(std::move(bytes)) {}

    [[nodiscard]] std::string_view bytes() const noexcept { return bytes_; }

private:
    std::string_view bytes_; // before owner_, which is moved from
    std::shared_ptr<const void> owner_;
};

/// A response body that is produced in pieces while it is sent, for content that may exceed the memory.
/// Threads: one caller of next() at a time, not on an I/O thread because it may wait for the disk.
class BodyStream {
public:
    BodyStream() = default;
    BodyStream(const BodyStream&) = delete;
    BodyStream& operator=(const BodyStream&) = delete;
    virtual ~BodyStream() = default;

    /// Returns the next piece, empty at the end. After an error the connection closes, so that the client detects that
    /// the body is incomplete.
    [[nodiscard]] virtual Result<std::string> next() = 0;
};

struct Response {
    Status status = Status::ok;
    std::vector<std::pair<std::string_view, std::string>> fields; ///< names are literals, "ETag"
    Body body;
    std::shared_ptr<const std::string> gzip = nullptr;           ///< the body as gzip, if already compressed
    std::shared_ptr<BodyStream> stream = nullptr;                ///< sent instead of `body` if set
    std::shared_ptr<const live::ViewedSession> viewed = nullptr; ///< with 101: a viewer takes over the connection

    Response& set(std::string_view field, std::string_view value) &;
    Response&& set(std::string_view field, std::string_view value) &&;

    /// Returns the field's value, or an empty string if it is not set. Field names are case-sensitive.
    [[nodiscard]] std::string_view get(std::string_view field) const;
};

/// 200 with a body.
[[nodiscard]] Response ok(std::string_view content_type, Body body);

/// 200 with JSON that must not be cached.
[[nodiscard]] Response ok(const boost::json::value& json);

/// 201 with JSON that describes what was created.
[[nodiscard]] Response created(const boost::json::value& json);

/// 204, without a body.
[[nodiscard]] Response no_content();

/// 304: the client already has the current content.
[[nodiscard]] Response not_modified(std::string_view etag, std::string_view cache_control);

/// Formats a time as an IMF-fixdate: "Sun, 06 Nov 1994 08:49:37 GMT".
/// Source: RFC 9110, section 5.6.7.
[[nodiscard]] std::string date_of(std::time_t time);

/// Returns date_of() the current time, formatted once a second. The view is valid until the next call on this thread.
[[nodiscard]] std::string_view date_now();

/// How the client detects the end of a response.
enum class Framing {
    kLength,      ///< Content-Length
    kChunked,     ///< Transfer-Encoding: chunked
    kUntilClosed, ///< the connection closes
};

/// Whether the connection stays open. Clients of HTTP/1.0 need the field `Connection: keep-alive`.
enum class Persistence { kClose, kKeepAlive, kKeepAliveOfHttp10 };

/// What a request states about its response.
struct Manner {
    bool with_body = true;
    bool keep_alive = false;
    bool takes_chunks = true; ///< HTTP/1.1
};

struct Transfer {
    Framing framing;
    Persistence persistence;
};

/// Returns how to send a response. A stream to a client that does not take chunks ends with the connection.
[[nodiscard]] Transfer transfer_of(const Response& response, const Manner& manner) noexcept;

/// Returns the status line and the fields up to the empty line, as sent. Adds the fields that every response has:
/// framing, persistence, and restrictions for browsers.
/// @param date       an IMF-fixdate (RFC 9110, section 5.6.7)
/// @param is_secure  whether the connection has TLS; then browsers are instructed to use only TLS (RFC 6797)
[[nodiscard]] std::string head_text(const Response& response, Persistence persistence, std::string_view date,
                                    Framing framing = Framing::kLength, bool is_secure = false);

} // namespace scanloom::http
