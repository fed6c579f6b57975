#include "robot_client/recordings/mcap_record.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>

namespace scanloom::robot {
namespace {

/// Takes values off the beginning of a text. After the first that is missing, all are.
class McapValues {
public:
    explicit McapValues(std::string_view bytes) : rest_(bytes) {}

    [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }

    std::string_view bytes(std::uint64_t count) {
        if (count > rest_.size()) is_complete_ = false;
        if (!is_complete_) return {};
        const auto taken = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return taken;
    }

    std::uint64_t number(std::size_t size) {
        const auto text = bytes(size);
        std::uint64_t value = 0;
        for (std::size_t i = text.size(); i-- > 0;) value = value << 8U | static_cast<unsigned char>(text[i]);
        return value;
    }

    std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    std::uint64_t u64() { return number(8); }
    std::string_view text() { return bytes(u32()); }

private:
    std::string_view rest_;
    bool is_complete_ = true;
};

constexpr std::uint64_t kChunkBytesMin = 40;

/// @return whether a record of this kind can have so many bytes of content
bool is_plausible(McapOp op, std::uint64_t size) {
    switch (op) {
    case McapOp::kHeader: return size >= 8;
    case McapOp::kFooter: return size == 20;
    case McapOp::kSchema: return size >= 14;
    case McapOp::kChannel: return size >= 16;
    case McapOp::kMessage: return size >= 22;
    case McapOp::kChunk: return size >= kChunkBytesMin;
    case McapOp::kMessageIndex: return size >= 6 && (size - 6) % 16 == 0;
    case McapOp::kChunkIndex: return size >= 64;
    case McapOp::kAttachment: return size >= 36;
    case McapOp::kAttachmentIndex: return size >= 48;
    case McapOp::kStatistics: return size >= 46;
    case McapOp::kMetadata: return size >= 8;
    case McapOp::kMetadataIndex: return size >= 20;
    case McapOp::kSummaryOffset: return size == 17;
    case McapOp::kDataEnd: return size == 4;
    }
    return true; // of a later version of the format, or private
}

bool is_known(McapOp op) { return op >= McapOp::kHeader && op <= McapOp::kDataEnd; }

/// Whether a record of this kind can be inside a chunk.
bool belongs_into_chunk(McapOp op) {
    return !is_known(op) || op == McapOp::kSchema || op == McapOp::kChannel || op == McapOp::kMessage;
}

/// Whether readers skip records of this kind.
bool is_skipped(McapOp op) {
    return !belongs_into_chunk(op) ? op != McapOp::kChunk && op != McapOp::kDataEnd && op != McapOp::kFooter
                                   : !is_known(op);
}

/// Reads what precedes the records of a chunk. @return false if it is malformed
Result<bool> read_chunk_header(RecordedBytes& bytes, McapRecord& record) {
    constexpr std::size_t kCompressionBytesMax = 32;
    constexpr std::size_t kHeaderBytesMax = 8 + 8 + 8 + 4 + 4 + kCompressionBytesMax + 8;
    const std::uint64_t size = record.end - record.data;
    auto first = bytes.peek(record.data, std::min<std::uint64_t>(size, kHeaderBytesMax));
    if (!first) return first.error();
    McapValues values(*first);
    values.u64(); // the first and the last time in it
    values.u64();
    record.unpacked_size = values.u64();
    record.checksum = values.u32();
    record.compression_name = values.text();
    const std::uint64_t records_size = values.u64();
    const std::uint64_t header_size = 8 + 8 + 8 + 4 + 4 + record.compression_name.size() + 8;
    if (!values.is_complete() || records_size > size - header_size) return false;
    record.data += header_size;
    record.end = record.data + records_size;
    // The first bytes say more of the compression than its name, which may be damaged.
    auto packed = bytes.peek(record.data, 4);
    if (!packed) return packed.error();
    record.compression = compression_of(*packed);
    record.is_packed = record.compression || !record.compression_name.empty();
    if (!record.is_packed) record.next = record.data;
    return true;
}

bool has_known_compression(const McapRecord& chunk) {
    return chunk.compression_name.empty() || chunk.compression_name == "lz4" || chunk.compression_name == "zstd";
}

Result<bool> read_message_header(RecordedBytes& bytes, McapRecord& record) {
    constexpr std::size_t kHeaderBytes = 2 + 4 + 8 + 8;
    auto first = bytes.peek(record.data, kHeaderBytes);
    if (!first) return first.error();
    McapValues values(*first);
    record.channel = values.u16();
    values.u32(); // its sequence number
    record.time = values.u64();
    record.data += kHeaderBytes;
    return first->size() == kHeaderBytes;
}

Result<bool> read_footer(RecordedBytes& bytes, McapRecord& record) {
    auto first = bytes.peek(record.data, 8);
    if (!first) return first.error();
    record.summary_begin = McapValues(*first).u64();
    return first->size() == 8;
}

} // namespace

std::optional<McapSchema> read_mcap_schema(std::string_view content) {
    McapValues values(content);
    McapSchema schema;
    schema.id = values.u16();
    schema.name = values.text();
    if (!values.is_complete() || schema.id == 0) return std::nullopt;
    return schema;
}

std::optional<McapChannel> read_mcap_channel(std::string_view content) {
    McapValues values(content);
    McapChannel channel;
    channel.id = values.u16();
    channel.schema = values.u16();
    channel.topic = values.text();
    channel.message_encoding = values.text();
    if (!values.is_complete()) return std::nullopt;
    return channel;
}

bool McapFormat::may_begin(std::string_view bytes) {
    McapValues values(bytes);
    const auto op = static_cast<McapOp>(values.number(1));
    return is_known(op) && is_plausible(op, values.u64());
}

bool McapFormat::can_be_in_chunk(const McapRecord& record) { return belongs_into_chunk(record.op); }

Result<std::optional<McapRecord>> McapFormat::read(RecordedBytes& bytes, std::uint64_t at) const {
    const auto none = std::optional<McapRecord>();
    auto first = bytes.peek(at, kFirstBytes);
    if (!first) return first.error();
    if (first->size() < kFirstBytes) return none;
    McapValues values(*first);
    McapRecord record;
    const auto op = static_cast<std::uint8_t>(values.number(1));
    record.op = static_cast<McapOp>(op);
    const std::uint64_t size = values.u64();
    constexpr std::uint64_t kSizeMax = std::uint64_t{1} << 62U; // so that sums do not overflow
    if (op == 0 || size > kSizeMax || !is_plausible(record.op, size)) return none;
    if (is_chunk && !belongs_into_chunk(record.op)) return none;
    record.begin = at;
    record.data = at + kFirstBytes;
    record.end = record.next = record.data + size;
    record.is_vague = !is_known(record.op);
    if (!is_chunk && is_skipped(record.op) && size >= kChunkBytesMin) {
        // A chunk whose op is damaged must not be skipped: other records do not have the values of a chunk.
        McapRecord chunk = record;
        chunk.op = McapOp::kChunk;
        chunk.is_vague = false;
        auto is_chunk_content = read_chunk_header(bytes, chunk);
        if (!is_chunk_content) return is_chunk_content.error();
        if (*is_chunk_content && has_known_compression(chunk)) return std::optional(std::move(chunk));
    }
    Result<bool> is_well_formed = true;
    if (record.op == McapOp::kMessage) is_well_formed = read_message_header(bytes, record);
    if (record.op == McapOp::kChunk) is_well_formed = read_chunk_header(bytes, record);
    if (record.op == McapOp::kFooter) is_well_formed = read_footer(bytes, record);
    if (!is_well_formed) return is_well_formed.error();
    return *is_well_formed ? std::optional(std::move(record)) : none;
}

} // namespace scanloom::robot
