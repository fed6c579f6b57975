#pragma once

#include "server/foxglove/schemas.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::foxglove {

/// Writes an MCAP file piece by piece: messages in chunks of about 1 MiB, compressed by Zstandard, each with an index;
/// at the end a summary. A file that is cut off can be read up to the last whole chunk.
/// Memory: a chunk, its piece of the file, and some 60 bytes for each chunk and channel that were written.
/// Source: https://mcap.dev/spec, format version 0.
class McapWriter {
public:
    using ChannelId = std::uint16_t;

    static constexpr std::size_t kChannelsMax = 65'535;
    static constexpr std::size_t kChunkBytes = std::size_t{1} << 20; ///< uncompressed; a chunk ends after it

    McapWriter();

    /// Adds a channel. Precondition: there are fewer than kChannelsMax.
    /// @param topic   unique
    /// @param schema  outlives this object
    /// @param qos     quality of service that rosbag2 offers when it plays the topic, in YAML; empty: its default
    [[nodiscard]] ChannelId add_channel(std::string topic, const Schema& schema, std::string_view qos = {});

    /// Adds a message.
    /// @param channel   of add_channel()
    /// @param log_time  nanoseconds, not negative, by which readers sort
    void write(ChannelId channel, std::int64_t log_time, std::string_view message);

    /// Ends the file. Call once, after the last message.
    void finish();

    /// Returns the bytes of the file that follow those returned before.
    [[nodiscard]] std::string take();

private:
    struct Channel {
        std::string topic;
        const Schema* schema;
        std::uint16_t schema_id;
        std::string qos;
        std::uint32_t messages = 0;
    };

    struct TimeRange {
        std::int64_t first = 0;
        std::int64_t last = 0;
        bool is_empty = true;

        void add(std::int64_t time) noexcept;
    };

    /// Times and offsets in the chunk of the messages of each channel.
    using ChunkMessages = std::map<ChannelId, std::vector<std::pair<std::int64_t, std::uint64_t>>>;

    struct WrittenChunk {
        TimeRange times;
        std::uint64_t begin = 0;                    ///< in the file
        std::uint64_t length = 0;                   ///< of its record
        std::map<ChannelId, std::uint64_t> indexes; ///< where the index of each channel begins in the file
        std::uint64_t index_length = 0;
        std::uint64_t compressed = 0;
        std::uint64_t uncompressed = 0;
    };

    [[nodiscard]] std::uint64_t position() const noexcept { return taken_ + out_.size(); }
    [[nodiscard]] std::string schema_record(std::size_t schema) const;
    [[nodiscard]] std::string channel_record(ChannelId channel) const;
    [[nodiscard]] std::string statistics_record() const;
    void end_chunk();

    std::string out_;         // not taken yet
    std::uint64_t taken_ = 0; // bytes
    std::vector<const Schema*> schemas_;
    std::vector<Channel> channels_;
    std::string chunk_; // records of the open chunk
    TimeRange chunk_times_;
    ChunkMessages chunk_messages_;
    std::vector<WrittenChunk> chunks_;
    TimeRange times_;
    std::uint64_t message_count_ = 0;
};

} // namespace scanloom::foxglove
