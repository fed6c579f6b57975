#include "robot_client/spool/record.hpp"

#include "common/wire/frame_decoder.hpp"

#include <boost/endian/conversion.hpp>

#include <cstdint>

namespace scanloom::robot {
namespace {

std::uint32_t load(std::string_view bytes) {
    return boost::endian::load_big_u32(reinterpret_cast<const unsigned char*>(bytes.data()));
}

} // namespace

void append_record(const wire::Message& message, std::string& out) {
    std::string frame;
    wire::encode(message, frame);
    const std::string_view body = std::string_view(frame).substr(wire::kLengthPrefixBytes);
    unsigned char header[kRecordHeaderBytes];
    boost::endian::store_big_u32(header, static_cast<std::uint32_t>(body.size()));
    boost::endian::store_big_u32(header + 4, checksum(body));
    out.append(reinterpret_cast<const char*>(header), sizeof header);
    out.append(body);
}

Result<std::optional<Record>> read_record(std::string_view bytes) {
    if (bytes.size() < kRecordHeaderBytes) return std::optional<Record>{};
    const std::uint32_t length = load(bytes);
    if (length == 0 || length > wire::kFrameBytesMax) return Error{Errc::kMalformed, "a record has an invalid length"};
    if (bytes.size() < kRecordHeaderBytes + length) return std::optional<Record>{};
    const std::string_view body = bytes.substr(kRecordHeaderBytes, length);
    if (load(bytes.substr(4)) != checksum(body)) return Error{Errc::kMalformed, "a record's checksum does not match"};
    auto message = wire::decode(body);
    if (!message) return message.error();
    return std::optional(Record{std::move(*message), kRecordHeaderBytes + length});
}

} // namespace scanloom::robot
