#include "robot_client/recordings/rosbag_record.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <array>

namespace scanloom::robot {
namespace {

constexpr std::size_t kBagLengthBytes = 4;

std::uint32_t bag_u32(std::string_view bytes) {
    return boost::endian::load_little_u32(reinterpret_cast<const unsigned char*>(bytes.data()));
}

std::uint64_t bag_u64(std::string_view bytes) {
    return boost::endian::load_little_u64(reinterpret_cast<const unsigned char*>(bytes.data()));
}

/// A field of a header: name=value.
struct BagField {
    std::string_view name;
    std::string_view value;
};

/// Takes the first field off `header`. @return nullopt if it is malformed
std::optional<BagField> take_bag_field(std::string_view& header) {
    if (header.size() < kBagLengthBytes) return std::nullopt;
    const std::size_t length = bag_u32(header);
    header.remove_prefix(kBagLengthBytes);
    if (length > header.size()) return std::nullopt;
    const auto field = header.substr(0, length);
    header.remove_prefix(length);
    const auto equals = field.find('=');
    if (equals == std::string_view::npos || equals == 0) return std::nullopt;
    return BagField{field.substr(0, equals), field.substr(equals + 1)};
}

/// Header fields, as far as they are known. Those that are absent are empty.
struct BagHeader {
    std::string_view op, conn, time, topic, size, ver, count, chunk_pos, index_pos, conn_count, encryptor;
};

std::optional<BagHeader> read_bag_header(std::string_view bytes) {
    BagHeader header;
    const std::pair<std::string_view, std::string_view*> fields[] = {
        {"op", &header.op},
        {"conn", &header.conn},
        {"time", &header.time},
        {"topic", &header.topic},
        {"size", &header.size},
        {"ver", &header.ver},
        {"count", &header.count},
        {"chunk_pos", &header.chunk_pos},
        {"index_pos", &header.index_pos},
        {"conn_count", &header.conn_count},
        {"encryptor", &header.encryptor},
    };
    while (!bytes.empty()) {
        const auto field = take_bag_field(bytes);
        if (!field) return std::nullopt;
        const auto known = std::ranges::find(fields, field->name, [](const auto& each) { return each.first; });
        if (known != std::end(fields)) *known->second = field->value;
    }
    return header;
}

/// @return whether the header has the fields of its kind
bool is_complete(const BagHeader& header, BagOp op, bool is_chunk) {
    const bool has_connection = header.conn.size() == 4;
    switch (op) {
    case BagOp::kMessage: return has_connection && header.time.size() == 8;
    case BagOp::kConnection: return has_connection;
    case BagOp::kBagHeader: return !is_chunk && header.index_pos.size() == 8;
    case BagOp::kIndex: return !is_chunk && has_connection && header.count.size() == 4;
    case BagOp::kChunk: return !is_chunk && header.size.size() == 4;
    case BagOp::kChunkInfo: return !is_chunk && header.chunk_pos.size() == 8;
    }
    return false;
}

} // namespace

BagConnection read_bag_connection(std::string_view data) {
    BagConnection connection;
    while (!data.empty()) {
        const auto field = take_bag_field(data);
        if (!field) break;
        if (field->name == "topic") connection.topic = field->value;
        if (field->name == "type") connection.type = field->value;
        if (field->name == "md5sum") connection.md5sum = field->value;
    }
    return connection;
}

bool BagFormat::may_begin(std::string_view bytes) {
    // The lengths of a header and of its first field.
    const std::uint32_t header = bag_u32(bytes);
    const std::uint32_t field = bag_u32(bytes.substr(kBagLengthBytes));
    return header <= kHeaderBytesMax && field >= 3 && std::uint64_t{field} + kBagLengthBytes <= header;
}

bool BagFormat::can_be_in_chunk(const BagRecord& record) {
    return record.op == BagOp::kMessage || record.op == BagOp::kConnection;
}

Result<std::optional<BagRecord>> BagFormat::read(RecordedBytes& bytes, std::uint64_t at) const {
    const auto none = std::optional<BagRecord>();
    auto first = bytes.peek(at, kFirstBytes);
    if (!first) return first.error();
    if (first->size() < kFirstBytes || !may_begin(*first)) return none;
    const std::size_t header_bytes = bag_u32(*first);
    auto all = bytes.peek(at, kBagLengthBytes + header_bytes + kBagLengthBytes);
    if (!all) return all.error();
    if (all->size() < kBagLengthBytes + header_bytes + kBagLengthBytes) return none;
    const auto header = read_bag_header(all->substr(kBagLengthBytes, header_bytes));
    if (!header || header->op.size() != 1) return none;

    BagRecord record;
    record.op = static_cast<BagOp>(header->op.front());
    if (!is_complete(*header, record.op, is_chunk)) return none; // or of an unknown kind, which 2.0 does not have
    record.begin = at;
    record.data = at + kBagLengthBytes + header_bytes + kBagLengthBytes;
    record.end = record.data + bag_u32(all->substr(kBagLengthBytes + header_bytes));
    record.next = record.end;
    const std::uint32_t unpacked_size = record.op == BagOp::kChunk ? bag_u32(header->size) : 0;
    switch (record.op) {
    case BagOp::kMessage: {
        record.connection = bag_u32(header->conn);
        constexpr std::int64_t kSecond = 1'000'000'000;
        record.time = kSecond * bag_u32(header->time) + bag_u32(header->time.substr(4));
        break;
    }
    case BagOp::kConnection:
        record.connection = bag_u32(header->conn);
        record.text = header->topic;
        break;
    case BagOp::kChunk: {
        // Its first bytes say more of the compression than the header, which may be damaged.
        auto packed = bytes.peek(record.data, 4);
        if (!packed) return packed.error();
        record.compression = compression_of(*packed);
        record.unpacked_size = unpacked_size;
        record.is_packed = record.compression.has_value();
        if (!record.is_packed) record.next = record.data;
        break;
    }
    case BagOp::kIndex: {
        // Bags of 2010 state a size of 20 bytes an entry, but an entry of an index of version 1 has 12.
        constexpr std::uint64_t kEntryBytes = 12;
        record.next_otherwise = record.data + kEntryBytes * bag_u32(header->count);
        break;
    }
    case BagOp::kBagHeader:
        record.index_begin = bag_u64(header->index_pos);
        record.text = header->encryptor;
        break;
    case BagOp::kChunkInfo: break;
    }
    return std::optional(std::move(record));
}

} // namespace scanloom::robot
