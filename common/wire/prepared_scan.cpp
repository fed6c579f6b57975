#include "common/wire/prepared_scan.hpp"

#include "common/wire/frame_checksum.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/proto_convert.hpp"

#include "scanloom/v1/frame.pb.h"

#include <boost/endian/conversion.hpp>
#include <google/protobuf/io/coded_stream.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <string_view>
#include <utility>

namespace scanloom::wire {
namespace {

using google::protobuf::io::CodedOutputStream;

// The tag before a field on the wire: the number and the wire type of the field.
constexpr std::uint32_t kVarint = 0, kFixed64 = 1, kDelimited = 2;
constexpr std::uint8_t tag(int field, std::uint32_t type) {
    return static_cast<std::uint8_t>(static_cast<std::uint32_t>(field) << 3 | type);
}
constexpr std::uint8_t kBatchTag = tag(v1::Frame::kScanBatchFieldNumber, kDelimited);
constexpr std::uint8_t kScanTag = tag(v1::ScanBatch::kScansFieldNumber, kDelimited);
constexpr std::uint8_t kSeqTag = tag(v1::Scan::kSeqFieldNumber, kVarint);
constexpr std::uint8_t kStampTag = tag(v1::Scan::kStampFieldNumber, kFixed64);
constexpr std::size_t kTagBytes = 1;

std::size_t varint_size(std::uint64_t value) { return CodedOutputStream::VarintSize64(value); }

std::size_t delimited_size(std::size_t content) { return kTagBytes + varint_size(content) + content; }

/// Returns whether protobuf writes the field: it omits 0, but not -0.
bool is_written(double stamp) { return std::bit_cast<std::uint64_t>(stamp) != 0; }

std::size_t scan_size(const NumberedScan& numbered) {
    const std::size_t stamp = is_written(numbered.stamp) ? kTagBytes + sizeof(double) : 0;
    return kTagBytes + varint_size(numbered.seq) + stamp + numbered.scan->bytes().size();
}

std::size_t batch_size(std::span<const NumberedScan> scans) {
    std::size_t size = 0;
    for (const NumberedScan& numbered : scans) size += delimited_size(scan_size(numbered));
    return size;
}

std::uint8_t* write_head(std::uint8_t tag_byte, std::size_t content, std::uint8_t* at) {
    *at++ = tag_byte;
    return CodedOutputStream::WriteVarint64ToArray(content, at);
}

std::uint8_t* write_scan(const NumberedScan& numbered, std::uint8_t* at) {
    at = write_head(kScanTag, scan_size(numbered), at);
    *at++ = kSeqTag;
    at = CodedOutputStream::WriteVarint64ToArray(numbered.seq, at);
    if (is_written(numbered.stamp)) {
        *at++ = kStampTag;
        at = CodedOutputStream::WriteLittleEndian64ToArray(std::bit_cast<std::uint64_t>(numbered.stamp), at);
    }
    const std::string& rest = numbered.scan->bytes();
    return CodedOutputStream::WriteRawToArray(rest.data(), static_cast<int>(rest.size()), at);
}

} // namespace

PreparedScan::PreparedScan(Scan scan) {
    scan.seq = 0;
    scan.stamp = 0.0;
    v1::Scan proto;
    to_proto(scan, proto);
    bytes_ = proto.SerializeAsString();
}

void encode_batch(std::span<const NumberedScan> scans, std::string& out) {
    const std::size_t batch = batch_size(scans);
    const std::size_t body = delimited_size(batch) + kChecksumBytes;
    assert(!scans.empty() && body <= kFrameBytesMax);
    const std::size_t begin = out.size();
    out.resize(begin + kLengthPrefixBytes + body);
    auto* at = reinterpret_cast<std::uint8_t*>(out.data()) + begin;
    boost::endian::store_big_u32(at, static_cast<std::uint32_t>(body));
    at = write_head(kBatchTag, batch, at + kLengthPrefixBytes);
    for (const NumberedScan& numbered : scans) at = write_scan(numbered, at);
    const auto content = std::string_view(out).substr(begin + kLengthPrefixBytes, body - kChecksumBytes);
    std::ranges::copy(checksum_field(content), at);
}

std::size_t batch_frame_size(std::span<const NumberedScan> scans) {
    return kLengthPrefixBytes + delimited_size(batch_size(scans)) + kChecksumBytes;
}

} // namespace scanloom::wire
