#pragma once

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/record_walker.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Records of ROS 1 bags, format 2.0.
///
/// Source: wiki.ros.org/Bags/Format/2.0.
namespace scanloom::robot {

enum class BagOp : std::uint8_t {
    kMessage = 0x02,
    kBagHeader = 0x03,
    kIndex = 0x04,
    kChunk = 0x05,
    kChunkInfo = 0x06,
    kConnection = 0x07,
};

/// A record's place and the fields of its header that matter.
struct BagRecord : RecordPlace {
    BagOp op{};
    std::uint32_t connection = 0;    ///< of messages and connections
    std::int64_t time = 0;           ///< of messages, in ns
    std::uint32_t unpacked_size = 0; ///< of chunks, in bytes
    std::uint64_t index_begin =
        0; ///< of bag headers: offset of the records after the last chunk, 0 if it was not closed
    std::optional<Compression> compression; ///< of chunks
    std::string text;                       ///< topic of a connection; encryptor of a bag header
};

/// Fields of a connection's data.
struct BagConnection {
    std::string topic; ///< empty if only the record's header has it
    std::string type;
    std::string md5sum;
};

[[nodiscard]] BagConnection read_bag_connection(std::string_view data);

/// Reads records for RecordWalker.
struct BagFormat {
    using Record = BagRecord;
    static constexpr std::size_t kFirstBytes = 8;
    static constexpr std::string_view kNumbered = "connection"; // what messages have the number of, for people
    static constexpr std::size_t kFollowers = 1;
    /// Longest header of a record.
    static constexpr std::size_t kHeaderBytesMax = 8000;

    bool is_chunk = false; ///< whether a chunk is read, which has no records but messages and connections

    [[nodiscard]] Result<std::optional<BagRecord>> read(RecordedBytes& bytes, std::uint64_t at) const;
    [[nodiscard]] static bool may_begin(std::string_view bytes);
    [[nodiscard]] static bool can_be_in_chunk(const BagRecord& record);
};

} // namespace scanloom::robot
