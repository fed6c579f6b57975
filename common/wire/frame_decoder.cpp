#include "common/wire/frame_decoder.hpp"

#include "common/wire/frame_checksum.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <iterator>

namespace scanloom::wire {

namespace {

/// The first bytes of HTTP requests and responses. As frame lengths, all of them are a gigabyte or more.
constexpr std::string_view kHttp[] = {"GET ", "HEAD", "POST", "PUT ", "DELE", "OPTI", "PATC", "CONN", "TRAC", "HTTP"};

/// The type and the major version of TLS's first record (RFC 8446, section 5.1). As a frame length it is 369 MB.
constexpr std::string_view kTlsHandshake = "\x16\x03";

void append_length(std::string& out, std::size_t bytes) {
    unsigned char prefix[kLengthPrefixBytes];
    boost::endian::store_big_u32(prefix, static_cast<std::uint32_t>(bytes));
    out.append(reinterpret_cast<const char*>(prefix), kLengthPrefixBytes);
}

} // namespace

std::span<std::byte> FrameDecoder::prepare(std::size_t bytes) {
    if (begin_ == end_) begin_ = end_ = 0;
    if (buffer_.size() - end_ < bytes && begin_ > 0) {
        std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
        end_ -= begin_;
        begin_ = 0;
    }
    if (buffer_.size() - end_ < bytes) buffer_.resize(end_ + bytes);
    return std::span(buffer_).subspan(end_);
}

void FrameDecoder::commit(std::size_t bytes) noexcept {
    assert(end_ + bytes <= buffer_.size());
    end_ += bytes;
}

Result<std::optional<std::string_view>> FrameDecoder::next() {
    if (failed_) return *failed_;
    const std::size_t available = end_ - begin_;
    if (available < kLengthPrefixBytes) return std::optional<std::string_view>{};

    const std::byte* head = buffer_.data() + begin_;
    const std::size_t length = boost::endian::load_big_u32(reinterpret_cast<const unsigned char*>(head));
    const std::string_view begin(reinterpret_cast<const char*>(head), kLengthPrefixBytes);
    if (std::ranges::find(kHttp, begin) != std::end(kHttp)) {
        holds_http_ = true;
        failed_ = Error{Errc::kMalformed,
                        fmt::format("the data begins with \"{}\": this is HTTP, not a frame; connect robots to the "
                                    "robot port (--listen), browsers to the HTTP port (--http)",
                                    begin)};
        return *failed_;
    }
    if (begin.starts_with(kTlsHandshake)) {
        failed_ = Error{Errc::kMalformed,
                        "the data is a TLS handshake, not a frame, and this port is not encrypted; connect without "
                        "TLS, or give the server a certificate (--robot-tls-cert)"};
        return *failed_;
    }
    if (length > frame_bytes_max_) {
        failed_ =
            Error{Errc::kTooLarge,
                  fmt::format("a frame announces {} bytes, at most {} are allowed {}", length, frame_bytes_max_,
                              frame_bytes_max_ < kFrameBytesMax ? "before the hello; send the hello first" : "here")};
        return *failed_;
    }
    if (length == 0) {
        failed_ = Error{Errc::kMalformed, "a frame of 0 bytes; every frame holds one scanloom.v1.Frame with a body"};
        return *failed_;
    }
    if (available < kLengthPrefixBytes + length) return std::optional<std::string_view>{};

    const std::string_view body(reinterpret_cast<const char*>(head + kLengthPrefixBytes), length);
    if (auto intact = check(body); !intact) {
        failed_ = intact.error();
        return *failed_;
    }
    begin_ += kLengthPrefixBytes + length;
    return std::optional(body);
}

/// Checks the checksum of a body. A missing one is an error after earlier frames had one, as damage to the field's tag
/// makes the field look absent.
Result<> FrameDecoder::check(std::string_view body) {
    const Checksum checksum = checksum_of(body);
    if (checksum == Checksum::kRight) has_checksums_ = true;
    if (checksum == Checksum::kRight || (checksum == Checksum::kAbsent && !has_checksums_)) return {};
    return Error{Errc::kDamaged, fmt::format("a frame of {} bytes was damaged in transmission: its checksum is {}; "
                                             "connect again, and check the network if it happens often",
                                             body.size(), checksum == Checksum::kWrong ? "wrong" : "missing")};
}

void append_checked_frame(std::string& out, std::string_view body) {
    assert(body.size() + kChecksumBytes <= kFrameBytesMax);
    append_length(out, body.size() + kChecksumBytes);
    const auto checksum = checksum_field(body);
    out.append(body).append(checksum.data(), checksum.size());
}

} // namespace scanloom::wire
