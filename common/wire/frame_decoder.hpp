#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::wire {

inline constexpr std::size_t kLengthPrefixBytes = 4;
inline constexpr std::size_t kFrameBytesMax = std::size_t{1} << 20; ///< after the hello
inline constexpr std::size_t kFrameBytesMaxBeforeHello = std::size_t{16} << 10;

/// Cuts a byte stream into frame bodies: `uint32 length, big-endian`, then that many bytes.
/// A state machine without a socket: however the stream is split, the same bodies come out.
///
/// Usage   read into prepare(), commit() what was read, then call next() until it is empty.
/// Checksums are optional, see frame_checksum.hpp; but a stream that has had one has them in every frame that follows.
///
/// Errors  kDamaged: a checksum is wrong, or was there before and is missing. kTooLarge as soon as a length prefix exceeds the limit, before anything is allocated for
///         it; kMalformed for an empty frame, or for HTTP or TLS in its place. After an error the stream has no
///         frame borders any more: every further next() repeats the error.
/// Thread  one at a time.
class FrameDecoder {
public:
    explicit FrameDecoder(std::size_t frame_bytes_max) : frame_bytes_max_(frame_bytes_max) {}

    /// A longer or shorter limit from the next frame on.
    void set_frame_bytes_max(std::size_t bytes) noexcept { frame_bytes_max_ = bytes; }

    /// Room for at least `bytes` more; valid until the next call of prepare() or next().
    [[nodiscard]] std::span<std::byte> prepare(std::size_t bytes);

    /// The first `bytes` of the prepared room now hold data.
    void commit(std::size_t bytes) noexcept;

    /// The next complete body, nothing if more bytes are needed.
    /// The view is valid until the next call of prepare().
    [[nodiscard]] Result<std::optional<std::string_view>> next();

    /// True when the error was HTTP in the place of a frame, as from a browser that found the wrong port.
    [[nodiscard]] bool holds_http() const noexcept { return holds_http_; }

private:
    [[nodiscard]] Result<> check(std::string_view body);

    std::size_t frame_bytes_max_;
    std::vector<std::byte> buffer_;
    std::size_t begin_ = 0; // first byte not yet handed out
    std::size_t end_ = 0;   // one past the last byte received
    std::optional<Error> failed_;
    bool holds_http_ = false;
    bool has_checksums_ = false; // of what came so far
};

/// A body with its length in front, ready to be sent. Pre: body.size() <= kFrameBytesMax.
void append_frame(std::string& out, std::string_view body);

/// The same with its checksum behind it. Pre: body.size() + kChecksumBytes <= kFrameBytesMax.
void append_checked_frame(std::string& out, std::string_view body);

} // namespace scanloom::wire
