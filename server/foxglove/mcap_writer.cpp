#include "server/foxglove/mcap_writer.hpp"

#include "server/foxglove/little_endian.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>

namespace scanloom::foxglove {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::string_view kCompression = "zstd";
constexpr int kCompressionLevel = 1;

/// The first byte of a record.
enum class Op : std::uint8_t {
    kHeader = 0x01,
    kFooter = 0x02,
    kSchema = 0x03,
    kChannel = 0x04,
    kMessage = 0x05,
    kChunk = 0x06,
    kMessageIndex = 0x07,
    kChunkIndex = 0x08,
    kStatistics = 0x0B,
    kSummaryOffset = 0x0E,
    kDataEnd = 0x0F,
};

void append_text(std::string& bytes, std::string_view text) {
    append_raw(bytes, static_cast<std::uint32_t>(text.size()));
    bytes.append(text);
}

/// Appends a list or map of pairs after its length in bytes.
template <class Pairs>
void append_pairs(std::string& bytes, const Pairs& pairs) {
    std::string content;
    for (const auto& [first, second] : pairs) append_raw(content, first), append_raw(content, second);
    append_text(bytes, content);
}

std::string record(Op op, std::string_view content) {
    std::string bytes;
    append_raw(bytes, op);
    append_raw(bytes, static_cast<std::uint64_t>(content.size()));
    return bytes.append(content);
}

std::uint32_t checksum(std::string_view bytes) {
    return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string compressed(std::string_view bytes) {
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kCompressionLevel));
    return packed;
}

} // namespace

void McapWriter::TimeRange::add(std::int64_t time) noexcept {
    first = is_empty ? time : std::min(first, time);
    last = is_empty ? time : std::max(last, time);
    is_empty = false;
}

McapWriter::McapWriter() : out_(kMagic) {
    std::string header;
    append_text(header, "ros2"); // the profile: how ROS 2 names and encodes types
    append_text(header, "scanloom " SCANLOOM_VERSION);
    out_ += record(Op::kHeader, header);
}

McapWriter::ChannelId McapWriter::add_channel(std::string topic, const Schema& schema, std::string_view qos) {
    const auto known = std::ranges::find(schemas_, &schema);
    const auto schema_index = static_cast<std::size_t>(known - schemas_.begin());
    if (known == schemas_.end()) {
        schemas_.push_back(&schema);
        chunk_ += schema_record(schema_index);
    }
    channels_.push_back({std::move(topic), &schema, static_cast<std::uint16_t>(schema_index + 1), std::string(qos)});
    const auto id = static_cast<ChannelId>(channels_.size());
    chunk_ += channel_record(id);
    return id;
}

void McapWriter::write(ChannelId channel, std::int64_t log_time, std::string_view message) {
    Channel& to = channels_[channel - 1U];
    chunk_messages_[channel].emplace_back(log_time, chunk_.size());
    std::string content;
    append_raw(content, channel);
    append_raw(content, ++to.messages);
    append_raw(content, log_time);
    append_raw(content, log_time); // publish_time
    chunk_ += record(Op::kMessage, content.append(message));
    chunk_times_.add(log_time);
    times_.add(log_time);
    ++message_count_;
    if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
    if (chunk_.empty()) return;
    const std::string packed = compressed(chunk_);
    std::string content;
    append_raw(content, chunk_times_.first);
    append_raw(content, chunk_times_.last);
    append_raw(content, static_cast<std::uint64_t>(chunk_.size()));
    append_raw(content, checksum(chunk_));
    append_text(content, kCompression);
    append_raw(content, static_cast<std::uint64_t>(packed.size()));
    content += packed;
    WrittenChunk written{chunk_times_, position(), 0, {}, 0, packed.size(), chunk_.size()};
    out_ += record(Op::kChunk, content);
    const std::uint64_t index_begin = position();
    written.length = index_begin - written.begin;
    for (const auto& [channel, messages] : chunk_messages_) {
        written.indexes[channel] = position();
        std::string index;
        append_raw(index, channel);
        append_pairs(index, messages);
        out_ += record(Op::kMessageIndex, index);
    }
    written.index_length = position() - index_begin;
    chunks_.push_back(std::move(written));
    chunk_.clear();
    chunk_times_ = {};
    chunk_messages_.clear();
}

void McapWriter::finish() {
    end_chunk();
    out_ += record(Op::kDataEnd, std::string(sizeof(std::uint32_t), '\0')); // its checksum is not computed
    const std::uint64_t summary_begin = position();
    std::string summary;
    std::string offsets;
    const auto add_group = [&](Op op, const std::string& records) {
        if (records.empty()) return;
        std::string offset;
        append_raw(offset, op);
        append_raw(offset, summary_begin + summary.size());
        append_raw(offset, static_cast<std::uint64_t>(records.size()));
        offsets += record(Op::kSummaryOffset, offset);
        summary += records;
    };
    std::string schemas;
    for (std::size_t n = 0; n < schemas_.size(); ++n) schemas += schema_record(n);
    std::string channels;
    for (std::size_t n = 1; n <= channels_.size(); ++n) channels += channel_record(static_cast<ChannelId>(n));
    std::string chunk_indexes;
    for (const WrittenChunk& chunk : chunks_) {
        std::string index;
        append_raw(index, chunk.times.first);
        append_raw(index, chunk.times.last);
        append_raw(index, chunk.begin);
        append_raw(index, chunk.length);
        append_pairs(index, chunk.indexes);
        append_raw(index, chunk.index_length);
        append_text(index, kCompression);
        append_raw(index, chunk.compressed);
        append_raw(index, chunk.uncompressed);
        chunk_indexes += record(Op::kChunkIndex, index);
    }
    add_group(Op::kSchema, schemas);
    add_group(Op::kChannel, channels);
    add_group(Op::kStatistics, statistics_record());
    add_group(Op::kChunkIndex, chunk_indexes);

    std::string footer; // the checksum covers it up to itself
    append_raw(footer, summary_begin);
    append_raw(footer, summary_begin + summary.size());
    const std::size_t with_checksum = footer.size() + sizeof(std::uint32_t);
    std::string end = summary + offsets;
    append_raw(end, Op::kFooter);
    append_raw(end, static_cast<std::uint64_t>(with_checksum));
    end += footer;
    append_raw(end, checksum(end));
    out_ += end;
    out_ += kMagic;
}

std::string McapWriter::take() {
    taken_ += out_.size();
    return std::exchange(out_, {});
}

std::string McapWriter::schema_record(std::size_t schema) const {
    std::string content;
    append_raw(content, static_cast<std::uint16_t>(schema + 1));
    append_text(content, schemas_[schema]->name);
    append_text(content, schemas_[schema]->encoding);
    append_text(content, schemas_[schema]->data);
    return record(Op::kSchema, content);
}

std::string McapWriter::channel_record(ChannelId channel) const {
    const Channel& written = channels_[channel - 1U];
    std::string content;
    append_raw(content, channel);
    append_raw(content, written.schema_id);
    append_text(content, written.topic);
    append_text(content, written.schema->message_encoding);
    std::string metadata;
    if (!written.qos.empty()) {
        append_text(metadata, "offered_qos_profiles");
        append_text(metadata, written.qos);
    }
    append_text(content, metadata);
    return record(Op::kChannel, content);
}

std::string McapWriter::statistics_record() const {
    std::string content;
    append_raw(content, message_count_);
    append_raw(content, static_cast<std::uint16_t>(schemas_.size()));
    append_raw(content, static_cast<std::uint32_t>(channels_.size()));
    append_raw(content, std::uint32_t{0}); // attachments
    append_raw(content, std::uint32_t{0}); // metadata
    append_raw(content, static_cast<std::uint32_t>(chunks_.size()));
    append_raw(content, times_.first);
    append_raw(content, times_.last);
    std::vector<std::pair<ChannelId, std::uint64_t>> counts;
    for (std::size_t n = 0; n < channels_.size(); ++n) {
        counts.emplace_back(static_cast<ChannelId>(n + 1), channels_[n].messages);
    }
    append_pairs(content, counts);
    return record(Op::kStatistics, content);
}

} // namespace scanloom::foxglove
