#include "robot_client/recordings/mcap.hpp"

#include "robot_client/recordings/chunked_recording.hpp"
#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/mcap_record.hpp"
#include "robot_client/recordings/packed_message.hpp"

#include <fmt/format.h>

#include <unordered_map>

#include <zlib.h>

namespace scanloom::robot {
namespace {

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
constexpr std::string_view kMcapMagicOfAll = "\x89MCAP";
constexpr std::size_t kDescriptionBytesMax = std::size_t{16} << 20; // of a schema or channel

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0) {
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

MessageEncoding mcap_encoding(std::string_view name) {
    if (name == "ros1") return MessageEncoding::kRos1;
    if (name == "cdr") return MessageEncoding::kCdr;
    return MessageEncoding::kOther;
}

class McapRecording final : public ChunkedRecording<McapFormat> {
public:
    explicit McapRecording(std::unique_ptr<RecordedBytes> file)
        : ChunkedRecording(std::move(file), kMcapMagic.size()) {}

private:
    [[nodiscard]] Taken take(const McapRecord& record, RecordedBytes& bytes) override {
        Result<> ok;
        switch (record.op) {
        case McapOp::kMessage:
            return unpack(take_message(record.channel, recorded_time(record.time), record, bytes), record);
        case McapOp::kSchema:
        case McapOp::kChannel: ok = take_description(record, bytes, false); break;
        case McapOp::kChunk: ok = record.is_packed ? take_packed_chunk(record) : check_plain_chunk(record); break;
        case McapOp::kDataEnd:
        case McapOp::kFooter: has_ended_ = true; break;
        default: break; // indices, attachments, and records of later versions
        }
        if (!ok) return ok.error();
        return std::optional<RecordedMessage>();
    }

    /// Decompresses a message that is compressed by itself.
    [[nodiscard]] Taken unpack(Taken taken, const McapRecord& record) {
        if (!taken || !*taken) return taken;
        std::string_view& bytes = (*taken)->bytes;
        if (!is_packed_message(topics_.all()[(*taken)->topic].encoding, bytes)) return taken;
        const auto reason = unpack_message(bytes, unpacked_);
        if (!reason) return taken;
        lose(record, fmt::format("a compressed message: {}", *reason));
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] Result<> take_again(const McapRecord& record) override {
        const bool is_description = record.op == McapOp::kSchema || record.op == McapOp::kChannel;
        return is_description ? take_description(record, *file_, true) : Result<>();
    }

    [[nodiscard]] Result<std::optional<std::uint64_t>> find_descriptions() override {
        constexpr std::size_t kFooterBytes = McapFormat::kFirstBytes + 20;
        const std::uint64_t end_bytes = kFooterBytes + kMcapMagic.size();
        if (file_->size() < end_bytes) return std::optional<std::uint64_t>();
        auto footer = McapFormat{}.read(*file_, file_->size() - end_bytes);
        if (!footer) return footer.error();
        const bool has_summary = *footer && (*footer)->op == McapOp::kFooter && (*footer)->summary_begin >= begin_ &&
                                 (*footer)->summary_begin < file_->size();
        return has_summary ? std::optional((*footer)->summary_begin) : std::nullopt;
    }

    /// Takes a schema or a channel.
    /// @param is_again  it is read in a search, and is the right one
    [[nodiscard]] Result<> take_description(const McapRecord& record, RecordedBytes& bytes, bool is_again) {
        const std::uint64_t size = record.end - record.data;
        if (size > kDescriptionBytesMax) {
            lose(record, fmt::format("a schema or channel of {} bytes", size));
            return {};
        }
        auto content = bytes.read(record.data, size);
        if (!content) return content.error();
        return record.op == McapOp::kSchema ? take_schema(record, *content, is_again)
                                            : take_channel(record, *content, is_again);
    }

    [[nodiscard]] Result<> take_schema(const McapRecord& record, std::string_view content, bool is_again) {
        const auto schema = read_mcap_schema(content);
        if (!schema || schema->name.size() > TopicList::kNameBytesMax) {
            lose(record, "a malformed schema");
            return {};
        }
        auto type = type_without_msg(schema->name);
        if (is_again) {
            schemas_.insert_or_assign(schema->id, std::move(type));
        } else {
            schemas_.try_emplace(schema->id, std::move(type));
        }
        return describe_channels_of(schema->id, record);
    }

    [[nodiscard]] Result<> take_channel(const McapRecord& record, std::string_view content, bool is_again) {
        const auto channel = read_mcap_channel(content);
        if (!channel) {
            lose(record, "a malformed channel");
            return {};
        }
        if (is_again) forget(channel->id, true);
        const auto schema = schemas_.find(channel->schema);
        if (schema == schemas_.end() && channel->schema != 0) {
            if (!is_described(channel->id)) untyped_.insert_or_assign(channel->id, *channel);
            return {};
        }
        untyped_.erase(channel->id);
        return describe(channel->id, topic_of(*channel, schema == schemas_.end() ? std::string() : schema->second),
                        record);
    }

    [[nodiscard]] static RecordedTopic topic_of(const McapChannel& channel, std::string type) {
        return {channel.topic, std::move(type), mcap_encoding(channel.message_encoding)};
    }

    /// Adds the channels that were described before their schema.
    [[nodiscard]] Result<> describe_channels_of(std::uint16_t schema, const McapRecord& record) {
        std::vector<McapChannel> described;
        std::erase_if(untyped_, [&](const auto& channel) {
            if (channel.second.schema != schema) return false;
            described.push_back(channel.second);
            return true;
        });
        for (const auto& channel : described) {
            forget(channel.id, false); // messages before have no type
            if (auto ok = describe(channel.id, topic_of(channel, schemas_.at(schema)), record); !ok) return ok;
        }
        return {};
    }

    /// The schema of a channel is nowhere: its messages are listed without a type.
    [[nodiscard]] Result<> describe_incomplete(Number number, const McapRecord& record) override {
        const auto channel = untyped_.find(static_cast<std::uint16_t>(number));
        return channel == untyped_.end() ? Result<>() : describe(number, topic_of(channel->second, {}), record);
    }

    [[nodiscard]] Result<> take_packed_chunk(const McapRecord& record) {
        if (!record.compression) {
            lose(record, fmt::format("a chunk with the unknown compression '{}'", shown_word(record.compression_name)));
            return {};
        }
        const auto packed = read_packed(record);
        if (!packed) return packed.error();
        if (!*packed) return {};
        const std::size_t size_max = std::min<std::uint64_t>(record.unpacked_size, kRecordedBytesMax);
        std::size_t taken = 0;
        const auto reason = decompress(*record.compression, **packed, size_max, decompressed_, &taken);
        if (!reason && record.is_end_unclear) records_.move_to(record.data + taken);
        if (reason) {
            lose_rest_of_chunk(record, *reason);
        } else if (record.checksum != 0 && crc32_of(decompressed_) != record.checksum) {
            lose_wrong_checksum(record, decompressed_.size());
            return {};
        }
        begin_chunk(record);
        return {};
    }

    void lose_wrong_checksum(const McapRecord& record, std::uint64_t size) {
        lose(record, fmt::format("a chunk of {} bytes, because its checksum is wrong", size));
    }

    /// Skips an uncompressed chunk whose checksum is wrong. The records of others are read from the file in turn.
    [[nodiscard]] Result<> check_plain_chunk(const McapRecord& record) {
        // If no record follows the chunk, its size is wrong, and the checksum of so many bytes says nothing.
        if (record.checksum == 0 || record.end > file_->size()) return {};
        if (record.end < file_->size()) {
            auto follows = McapFormat{}.read(*file_, record.end);
            if (!follows) return follows.error();
            if (!*follows) return {};
        }
        constexpr std::size_t kPieceBytes = 65'536;
        std::uint32_t checksum = 0;
        for (std::uint64_t at = record.data; at < record.end;) {
            auto piece = file_->read(at, std::min<std::uint64_t>(kPieceBytes, record.end - at));
            if (!piece) return piece.error();
            if (piece->empty()) return {}; // the file has become shorter
            checksum = crc32_of(*piece, checksum);
            at += piece->size();
        }
        if (checksum == record.checksum) return {};
        lose_wrong_checksum(record, record.end - record.data);
        records_.move_to(record.end);
        return {};
    }

    void lose_end() override { lose_at_end("the recording was not closed: its end may be missing"); }

    std::string unpacked_;                                   // a message that is compressed by itself
    std::unordered_map<std::uint16_t, std::string> schemas_; // to types
    std::unordered_map<std::uint16_t, McapChannel> untyped_; // whose schemas are not described so far
};

} // namespace

bool is_mcap(std::string_view first_bytes) { return first_bytes.starts_with(kMcapMagicOfAll); }

Result<std::unique_ptr<Recording>> open_mcap(std::unique_ptr<RecordedBytes> file, std::string name) {
    auto first = file->read(0, kMcapMagic.size());
    if (!first) return first.error();
    if (*first != kMcapMagic && is_mcap(*first) && first->size() == kMcapMagic.size()) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: an MCAP file of version '{}'; only version 0 can be read. Convert it with the "
                                 "`mcap` tool of its version",
                                 name, shown_word(first->substr(kMcapMagicOfAll.size(), 1)))};
    }
    if (*first != kMcapMagic) return Error{Errc::kMalformed, fmt::format("{}: not an MCAP file", name)};
    return std::unique_ptr<Recording>(std::make_unique<McapRecording>(std::move(file)));
}

} // namespace scanloom::robot
