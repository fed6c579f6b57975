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
inline constexpr std::size_t kFrameBytesMax = std::size_t{1} << 20; ///< once the hello is accepted
inline constexpr std::size_t kFrameBytesMaxBeforeHello = std::size_t{16} << 10;

/// Splits a byte stream into frame bodies: a big-endian uint32 length, then that many bytes. This is a state machine
/// without a socket: it gives the same bodies however the stream is split.
///
/// Usage: read into prepare(), commit() what was read, then call next() until it returns nullopt.
///
/// Checksums are optional (see frame_checksum.hpp), but once a frame has one, every later frame of the stream must have
/// one.
///
/// Errors: kDamaged if a checksum is wrong, or missing after an earlier frame had one; kTooLarge as soon as a length
///         prefix exceeds the limit, before memory is allocated for the frame; kMalformed for an empty frame, or for
///         HTTP or TLS instead of a frame. After an error the frame boundaries are lost: every further next() returns
///         the same error.
/// Threads: one at a time.
class FrameDecoder {
public:
    explicit FrameDecoder(std::size_t frame_bytes_max) : frame_bytes_max_(frame_bytes_max) {}

    /// Changes the limit from the next frame on.
    void set_frame_bytes_max(std::size_t bytes) noexcept { frame_bytes_max_ = bytes; }

    /// Returns space for at least `bytes` more bytes, valid until the next call of prepare() or next().
    [[nodiscard]] std::span<std::byte> prepare(std::size_t bytes);

    /// Marks the first `bytes` of the prepared space as received.
    void commit(std::size_t bytes) noexcept;

    /// Returns the next complete body; nullopt if more bytes are needed. The view is valid until the next call of
    /// prepare().
    [[nodiscard]] Result<std::optional<std::string_view>> next();

    /// Returns whether the error was HTTP instead of a frame, as from a browser that connects to the wrong port.
    [[nodiscard]] bool holds_http() const noexcept { return holds_http_; }

private:
    [[nodiscard]] Result<> check(std::string_view body);

    std::size_t frame_bytes_max_;
    std::vector<std::byte> buffer_;
    std::size_t begin_ = 0; // first byte not yet handed out
    std::size_t end_ = 0;   // one past the last byte received
    std::optional<Error> failed_;
    bool holds_http_ = false;
    bool has_checksums_ = false; // whether a received frame had one
};

/// Appends a frame to `out`: the length prefix, the body and its checksum.
/// Precondition: body.size() + kChecksumBytes <= kFrameBytesMax.
void append_checked_frame(std::string& out, std::string_view body);

} // namespace scanloom::wire
