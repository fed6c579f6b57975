#include "robot_client/recordings/mcap.hpp"

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/lz4_tail.hpp"
#include "robot_client/recordings/mcap_record.hpp"
#include "robot_client/recordings/packed_message.hpp"
#include "robot_client/recordings/record_walker.hpp"
#include "robot_client/recordings/recording_lists.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <unordered_set>

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

class McapRecording final : public Recording {
public:
    explicit McapRecording(std::unique_ptr<RecordedBytes> file)
        : file_(std::move(file)), records_(McapFormat{}, *file_, kMcapMagic.size()) {}

    [[nodiscard]] Result<std::optional<RecordedMessage>> next() override {
        while (!has_ended_) {
            RecordedBytes& bytes = chunk_ ? static_cast<RecordedBytes&>(chunk_->bytes) : *file_;
            auto step = chunk_ ? chunk_->records.next() : records_.next();
            if (!step) return step.error();
            if (step->gap) lose_gap(*step->gap, bytes);
            if (!step->record) {
                if (!chunk_) {
                    losses_.add(file_->size(), "the recording was not closed: its end may be missing");
                    has_ended_ = true;
                }
                chunk_.reset();
                continue;
            }
            auto message = take(*step->record, bytes);
            if (!message) return message.error();
            if (*message) return message;
        }
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] const std::vector<RecordedTopic>& topics() const override { return topics_.all(); }
    [[nodiscard]] const std::vector<RecordingLoss>& losses() const override { return losses_.listed(); }
    [[nodiscard]] std::uint64_t losses_count() const override { return losses_.count(); }
    [[nodiscard]] ReadProgress progress() const override {
        return {has_ended_ ? file_->size() : records_.position(), file_->size()};
    }

private:
    using Taken = Result<std::optional<RecordedMessage>>;

    /// Where the description of an unknown channel is searched next.
    enum class Search { kSummary, kFile, kDone };

    /// The decompressed records of a chunk.
    struct Chunk {
        Chunk(std::string_view decompressed, std::uint64_t begin)
            : bytes(decompressed), records(McapFormat{.is_chunk = true}, bytes, 0), offset(begin) {}

        BytesInMemory bytes;
        RecordWalker<McapFormat> records;
        std::uint64_t offset; ///< of the chunk in the file
    };

    void lose_gap(const RecordGap& gap, const RecordedBytes& bytes) {
        const auto what = fmt::format("{} bytes are damaged or incomplete", gap.end - gap.begin);
        if (!chunk_) return losses_.add(gap.begin, what);
        losses_.add(chunk_->offset, fmt::format("{} of the {} decompressed bytes of a chunk", what, bytes.size()));
    }

    /// Adds a loss in a record: at its place in the file, or at the place of its chunk.
    void lose(const McapRecord& record, std::string reason) {
        losses_.add(chunk_ ? chunk_->offset : record.begin, std::move(reason));
    }

    [[nodiscard]] Taken take(const McapRecord& record, RecordedBytes& bytes) {
        Result<> ok;
        switch (record.op) {
        case McapOp::kMessage: return take_message(record, bytes);
        case McapOp::kSchema:
        case McapOp::kChannel: ok = take_description(record, bytes); break;
        case McapOp::kChunk: ok = record.is_packed ? take_packed_chunk(record) : check_plain_chunk(record); break;
        case McapOp::kDataEnd:
        case McapOp::kFooter: has_ended_ = true; break;
        default: break; // indices, attachments, and records of later versions
        }
        if (!ok) return ok.error();
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] Taken take_message(const McapRecord& record, RecordedBytes& bytes) {
        const auto none = std::optional<RecordedMessage>();
        auto known = channels_.find(record.channel);
        while (known == channels_.end() && search_ != Search::kDone) {
            if (auto ok = search_channels(); !ok) return ok.error();
            known = channels_.find(record.channel);
        }
        if (known == channels_.end()) {
            // The schema of a channel is nowhere: its messages are listed without a type.
            if (const auto channel = untyped_.find(record.channel); channel != untyped_.end()) {
                if (auto ok = add_channel(channel->second, {}, record); !ok) return ok.error();
                known = channels_.find(record.channel);
            }
        }
        if (known == channels_.end()) {
            lose(record, fmt::format("a message of channel {}, which is not described", record.channel));
            return none;
        }
        const std::uint64_t size = record.end - record.data;
        if (size > kRecordedBytesMax) {
            lose(record, fmt::format("a message of {} bytes; at most {} are supported", size, kRecordedBytesMax));
            return none;
        }
        auto data = bytes.read(record.data, size);
        if (!data) return data.error();
        if (data->size() < size) return none; // the file has become shorter: the records say so
        std::string_view message = *data;
        if (is_packed_message(topics_.all()[known->second].encoding, message)) {
            if (const auto reason = unpack_message(message, unpacked_)) {
                lose(record, fmt::format("a compressed message: {}", *reason));
                return none;
            }
        }
        return std::optional(RecordedMessage{known->second, recorded_time(record.time), message});
    }

    /// Takes a schema or a channel.
    [[nodiscard]] Result<> take_description(const McapRecord& record, RecordedBytes& bytes, bool is_summary = false) {
        const std::uint64_t size = record.end - record.data;
        if (size > kDescriptionBytesMax) {
            lose(record, fmt::format("a schema or channel of {} bytes", size));
            return {};
        }
        auto content = bytes.read(record.data, size);
        if (!content) return content.error();
        if (record.op == McapOp::kSchema) {
            const auto schema = read_mcap_schema(*content);
            if (!schema || schema->name.size() > TopicList::kNameBytesMax) {
                lose(record, "a malformed schema");
            } else {
                auto type = type_without_msg(schema->name);
                is_summary ? void(schemas_.insert_or_assign(schema->id, std::move(type)))
                           : void(schemas_.try_emplace(schema->id, std::move(type)));
                return describe_channels_of(schema->id, record);
            }
            return {};
        }
        const auto channel = read_mcap_channel(*content);
        if (!channel) {
            lose(record, "a malformed channel");
            return {};
        }
        if (is_summary) {
            channels_.erase(channel->id);
            summarized_.insert(channel->id);
        }
        const auto schema = schemas_.find(channel->schema);
        if (schema == schemas_.end() && channel->schema != 0) {
            if (!channels_.contains(channel->id)) untyped_.insert_or_assign(channel->id, *channel);
            return {};
        }
        untyped_.erase(channel->id);
        return add_channel(*channel, schema == schemas_.end() ? std::string() : schema->second, record);
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
            channels_.erase(channel.id); // messages before have no type
            if (auto ok = add_channel(channel, schemas_.at(schema), record); !ok) return ok;
        }
        return {};
    }

    /// Adds a channel.
    /// @param type    of its messages; empty: unknown
    /// @param record  that describes it, or its schema
    [[nodiscard]] Result<> add_channel(const McapChannel& channel, std::string type, const McapRecord& record) {
        auto topic = topics_.add({channel.topic, std::move(type), mcap_encoding(channel.message_encoding)});
        if (!topic) {
            lose(record, "a topic, because there are too many or its name is too long");
            return {};
        }
        const auto [known, is_new] = channels_.try_emplace(channel.id, *topic);
        if (is_new || known->second == *topic) return {};
        // One of the two has a damaged number. The description in the summary decides, else the newest one.
        lose(record, fmt::format("channel {}, which is described in two ways", channel.id));
        if (search_ == Search::kSummary) {
            if (auto ok = search_channels(); !ok) return ok;
        }
        if (!summarized_.contains(channel.id)) channels_[channel.id] = *topic;
        return {};
    }

    [[nodiscard]] Result<> take_packed_chunk(const McapRecord& record) {
        if (!record.compression) {
            lose(record, fmt::format("a chunk with the unknown compression '{}'", shown_word(record.compression_name)));
            return {};
        }
        const std::uint64_t packed_size = record.end - record.data;
        if (packed_size > kRecordedBytesMax) {
            lose(record, fmt::format("a chunk of {} bytes; at most {} are supported", packed_size, kRecordedBytesMax));
            return {};
        }
        auto packed = file_->read(record.data, packed_size);
        if (!packed) return packed.error();
        const std::size_t size_max = std::min<std::uint64_t>(record.unpacked_size, kRecordedBytesMax);
        std::size_t taken = 0;
        const auto reason = decompress(*record.compression, *packed, size_max, decompressed_, &taken);
        if (!reason && record.is_end_unclear) records_.move_to(record.data + taken);
        if (reason) {
            lose(record,
                 fmt::format("a part of a chunk: {}; {} bytes could be decompressed", *reason, decompressed_.size()));
        } else if (record.checksum != 0 && crc32_of(decompressed_) != record.checksum) {
            lose_wrong_checksum(record, decompressed_.size());
            return {};
        }
        chunk_.emplace(decompressed_, record.begin);
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

    /// Reads the schemas and channels that are repeated in the summary: first where the footer says, and the next time
    /// anywhere outside of compressed chunks.
    [[nodiscard]] Result<> search_channels() {
        const bool is_first = search_ == Search::kSummary;
        search_ = is_first ? Search::kFile : Search::kDone;
        if (!is_first) return read_descriptions(kMcapMagic.size());
        constexpr std::size_t kFooterBytes = McapFormat::kFirstBytes + 20;
        const std::uint64_t end_bytes = kFooterBytes + kMcapMagic.size();
        if (file_->size() < end_bytes) return {};
        auto footer = McapFormat{}.read(*file_, file_->size() - end_bytes);
        if (!footer) return footer.error();
        const bool has_summary = *footer && (*footer)->op == McapOp::kFooter &&
                                 (*footer)->summary_begin >= kMcapMagic.size() &&
                                 (*footer)->summary_begin < file_->size();
        return has_summary ? read_descriptions((*footer)->summary_begin) : Result<>();
    }

    [[nodiscard]] Result<> read_descriptions(std::uint64_t from) {
        RecordWalker<McapFormat> records(McapFormat{}, *file_, from);
        for (;;) {
            auto step = records.next();
            if (!step) return step.error();
            if (!step->record) return {};
            if (step->record->op != McapOp::kSchema && step->record->op != McapOp::kChannel) continue;
            if (auto ok = take_description(*step->record, *file_, true); !ok) return ok;
        }
    }

    std::unique_ptr<RecordedBytes> file_;
    RecordWalker<McapFormat> records_;
    std::string decompressed_;                                // the records of a chunk
    std::string unpacked_;                                    // a message that is compressed by itself
    std::optional<Chunk> chunk_;                              // while its records are read
    std::unordered_map<std::uint16_t, std::string> schemas_;  // to types
    std::unordered_map<std::uint16_t, std::size_t> channels_; // to topics
    std::unordered_map<std::uint16_t, McapChannel> untyped_;  // whose schemas are not described so far
    std::unordered_set<std::uint16_t> summarized_;            // channels that the summary describes, once it is read
    TopicList topics_;
    LossList losses_;
    Search search_ = Search::kSummary;
    bool has_ended_ = false;
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
