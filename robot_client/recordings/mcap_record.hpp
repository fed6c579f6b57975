#pragma once

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/record_walker.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Records of MCAP files, version 0.
///
/// Source: mcap.dev/spec.
namespace scanloom::robot {

enum class McapOp : std::uint8_t {
    kHeader = 0x01,
    kFooter = 0x02,
    kSchema = 0x03,
    kChannel = 0x04,
    kMessage = 0x05,
    kChunk = 0x06,
    kMessageIndex = 0x07,
    kChunkIndex = 0x08,
    kAttachment = 0x09,
    kAttachmentIndex = 0x0a,
    kStatistics = 0x0b,
    kMetadata = 0x0c,
    kMetadataIndex = 0x0d,
    kSummaryOffset = 0x0e,
    kDataEnd = 0x0f,
};

/// A record's place and the fields that matter. The data of a message is the message, that of a chunk its records;
/// other data is the content of the record.
struct McapRecord : RecordPlace {
    McapOp op{};
    std::uint16_t channel = 0;              ///< of messages
    std::uint64_t time = 0;                 ///< of messages: when it was recorded, in ns
    std::uint64_t unpacked_size = 0;        ///< of chunks, in bytes
    std::uint32_t checksum = 0;             ///< of chunks: CRC-32 of the decompressed records, 0 if there is none
    std::uint64_t summary_begin = 0;        ///< of footers: offset of the summary, 0 if there is none
    std::optional<Compression> compression; ///< of chunks
    std::string compression_name;           ///< of chunks; empty: they are not compressed
};

/// Content of a Schema record.
struct McapSchema {
    std::uint16_t id = 0;
    std::string name;
};
[[nodiscard]] std::optional<McapSchema> read_mcap_schema(std::string_view content);

/// Content of a Channel record.
struct McapChannel {
    std::uint16_t id = 0;
    std::uint16_t schema = 0; ///< 0 if it has none
    std::string topic;
    std::string message_encoding;
};
[[nodiscard]] std::optional<McapChannel> read_mcap_channel(std::string_view content);

/// Reads records for RecordWalker.
struct McapFormat {
    using Record = McapRecord;
    static constexpr std::size_t kFirstBytes = 9;
    static constexpr std::string_view kNumbered = "channel"; // what messages have the number of, for people
    static constexpr std::size_t kFollowers = 2;             // a record has little that can be checked

    bool is_chunk = false; ///< whether a chunk is read, which has no records but schemas, channels and messages

    [[nodiscard]] Result<std::optional<McapRecord>> read(RecordedBytes& bytes, std::uint64_t at) const;
    [[nodiscard]] static bool may_begin(std::string_view bytes);
    [[nodiscard]] static bool can_be_in_chunk(const McapRecord& record);
};

} // namespace scanloom::robot
