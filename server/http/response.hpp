#pragma once

#include "server/http/body_stream.hpp"

#include <boost/beast/http/status.hpp>
#include <boost/json/value.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::live {
struct Invitation;
}

namespace scanloom::http {

using Status = boost::beast::http::status;

inline constexpr std::string_view kJson = "application/json";
inline constexpr std::string_view kGeoJson = "application/geo+json";

/// For what may be kept, but must be asked for again with If-None-Match.
inline constexpr std::string_view kRevalidate = "no-cache";
/// For what changes with every scan and has no version.
inline constexpr std::string_view kNotKept = "no-store";
/// For what never changes under its address.
inline constexpr std::string_view kImmutable = "public, max-age=31536000, immutable";

/// Bytes to be sent, kept alive by whoever made them: what many ask for exists once.
class Body {
public:
    Body() = default;
    explicit Body(std::string text) : Body(std::make_shared<const std::string>(std::move(text))) {}

    /// Of a string or a vector of bytes.
    template <class Container>
    explicit Body(std::shared_ptr<const Container> bytes)
        : bytes_(reinterpret_cast<const char*>(bytes->data()), bytes->size()), owner_(std::move(bytes)) {}

    [[nodiscard]] std::string_view bytes() const noexcept { return bytes_; }

private:
    std::string_view bytes_; // before owner_, which is moved from
    std::shared_ptr<const void> owner_;
};

/// An answer.
struct Response {
    Status status = Status::ok;
    std::vector<std::pair<std::string_view, std::string>> fields; ///< names are literals, "ETag"
    Body body;
    std::shared_ptr<const std::string> gzip = nullptr;            ///< the body as gzip, where it was compressed before
    std::shared_ptr<BodyStream> stream = nullptr;                 ///< in place of `body`
    std::shared_ptr<const live::Invitation> invitation = nullptr; ///< with 101: the connection becomes a viewer's

    Response& set(std::string_view field, std::string_view value) &;
    Response&& set(std::string_view field, std::string_view value) &&;

    /// The field's value, empty when it is not set. Field names are compared as they are spelled.
    [[nodiscard]] std::string_view get(std::string_view field) const;
};

/// 200 with a body.
[[nodiscard]] Response ok(std::string_view content_type, Body body);

/// 200 with JSON that is not to be kept.
[[nodiscard]] Response ok(const boost::json::value& json);

/// 304: the one who asks has it already.
[[nodiscard]] Response not_modified(std::string_view etag, std::string_view cache_control);

/// How whoever reads an answer knows its end.
enum class Framing {
    kLength,      ///< Content-Length
    kChunked,     ///< Transfer-Encoding: chunked
    kUntilClosed, ///< the connection's end
};

/// Whether the connection stays open. Clients of HTTP/1.0 need the field `Connection: keep-alive`.
enum class Persistence { kClose, kKeepAlive, kKeepAliveOfHttp10 };

/// Status line and fields up to the empty line, as they go over the wire; with what every answer
/// carries: its framing, whether the connection stays, and what browsers may do with it.
/// `date` is an IMF-fixdate (RFC 9110, section 5.6.7); `is_secure`: it goes over TLS, and browsers are told to come
/// back so alone (RFC 6797).
[[nodiscard]] std::string head_text(const Response& response, Persistence persistence, std::string_view date,
                                    Framing framing = Framing::kLength, bool is_secure = false);

} // namespace scanloom::http
