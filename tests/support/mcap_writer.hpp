#pragma once

#include "tests/support/written_recording.hpp"

#include <fmt/format.h>

#include <zlib.h>

/// Writes MCAP files of version 0 for tests.
namespace scanloom::testing_support {

struct McapOptions {
    std::string compression;       ///< of chunks: "", "lz4" or "zstd"
    std::size_t chunk_bytes = 400; ///< a chunk ends once it has so many; 0: no chunks
    bool has_checksums = true;
    bool is_closed = true; ///< false: as a recorder that crashed leaves it, without an end and a summary
    bool has_summary = true;
    bool has_late_schemas = false; ///< each after its channel
};

class McapWriter {
public:
    explicit McapWriter(McapOptions options = {}) : options_(std::move(options)) {
        recording_.file = std::string(kMagic);
        std::string header;
        append_counted(header, "ros2");
        append_counted(header, "tests");
        recording_.file += record(0x01, header);
    }

    /// @return the channel's number
    std::uint16_t connect(const std::string& topic, const std::string& type, const std::string& encoding = "cdr") {
        const auto number = static_cast<std::uint16_t>(channels_.size() + 1);
        std::string schema;
        append_little(schema, number);
        append_counted(schema, type);
        append_counted(schema, "ros2msg");
        append_counted(schema, "uint8 x\n");
        std::string channel;
        append_little(channel, number);
        append_little(channel, number);
        append_counted(channel, topic);
        append_counted(channel, encoding);
        append_counted(channel, "");
        const std::string descriptions[] = {record(0x03, schema), record(0x04, channel)};
        const bool is_late = options_.has_late_schemas;
        channels_.push_back({topic, descriptions[is_late ? 1 : 0] + descriptions[is_late ? 0 : 1], false});
        return number;
    }

    void write(std::uint16_t channel, std::int64_t time, const std::string& bytes) {
        Channel& it = channels_.at(channel - 1U);
        std::string& place = options_.chunk_bytes == 0 ? recording_.file : chunk_;
        if (!it.is_written) {
            descriptions_.push_back({place.size(), place.size() + it.records.size(), it.topic});
            place += it.records;
            it.is_written = true;
        }
        const std::size_t begin = place.size();
        place += message_record(channel, time, bytes);
        messages_.push_back({it.topic, time, bytes, begin, place.size()});
        if (options_.chunk_bytes == 0) take_messages(0, 0, true);
        if (options_.chunk_bytes > 0 && chunk_.size() >= options_.chunk_bytes) end_chunk();
    }

    /// Writes bytes between two chunks.
    void write_raw(std::string_view bytes) {
        end_chunk();
        recording_.file += bytes;
    }

    [[nodiscard]] static std::string record(std::uint8_t op, std::string_view content) {
        std::string bytes(1, static_cast<char>(op));
        append_little(bytes, static_cast<std::uint64_t>(content.size()));
        return bytes.append(content);
    }

    [[nodiscard]] static std::string message_record(std::uint16_t channel, std::int64_t time,
                                                    const std::string& bytes) {
        std::string content;
        append_little(content, channel);
        append_little(content, std::uint32_t{0});
        append_little(content, static_cast<std::uint64_t>(time));
        append_little(content, static_cast<std::uint64_t>(time));
        return record(0x05, content + bytes);
    }

    void end_chunk() {
        if (chunk_.empty()) return;
        const std::string packed = compressed(options_.compression, chunk_);
        std::string content;
        append_little(content, static_cast<std::uint64_t>(messages_.front().time));
        append_little(content, static_cast<std::uint64_t>(messages_.back().time));
        append_little(content, static_cast<std::uint64_t>(chunk_.size()));
        append_little(content, options_.has_checksums ? crc_of(chunk_) : 0U);
        append_counted(content, options_.compression);
        append_little(content, static_cast<std::uint64_t>(packed.size()));
        const std::size_t begin = recording_.file.size();
        recording_.file += record(0x06, content + packed);
        take_messages(begin, recording_.file.size() - packed.size(), options_.compression.empty());
        chunk_.clear();
        std::string index; // readers do not need it
        append_little(index, std::uint16_t{1});
        append_little(index, std::uint32_t{0});
        recording_.file += record(0x07, index);
    }

    /// Ends the file. @return it, and where its messages are
    [[nodiscard]] WrittenRecording finish() {
        end_chunk();
        if (!options_.is_closed) return recording_;
        recording_.file += record(0x0f, std::string(4, '\0'));
        const std::uint64_t summary = options_.has_summary ? recording_.file.size() : 0;
        if (options_.has_summary) {
            for (const auto& channel : channels_) recording_.file += channel.records;
        }
        std::string footer;
        append_little(footer, summary);
        footer += std::string(12, '\0');
        recording_.file += record(0x02, footer) + std::string(kMagic);
        return recording_;
    }

private:
    static constexpr std::string_view kMagic = "\x89MCAP0\r\n";

    struct Channel {
        std::string topic;
        std::string records;
        bool is_written = false;
    };

    static std::uint32_t crc_of(std::string_view bytes) {
        return static_cast<std::uint32_t>(
            crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned>(bytes.size())));
    }

    /// Moves what was written to the recording. Places are relative to `data` unless the chunk is compressed.
    void take_messages(std::size_t chunk, std::size_t data, bool is_plain) {
        for (auto& message : messages_) {
            message.begin = is_plain ? data + message.begin : chunk;
            message.end = is_plain ? data + message.end : recording_.file.size();
            message.checksum_at = chunk + 9 + 24;
            recording_.messages.push_back(message);
        }
        for (auto& part : descriptions_) {
            if (is_plain) recording_.descriptions.push_back({data + part.begin, data + part.end, part.topic});
        }
        messages_.clear();
        descriptions_.clear();
    }

    McapOptions options_;
    WrittenRecording recording_;
    std::vector<Channel> channels_;
    std::string chunk_; // its records so far
    std::vector<WrittenMessage> messages_;
    std::vector<WrittenPart> descriptions_;
};

/// An MCAP file with two topics and messages of various sizes.
inline WrittenRecording small_mcap(McapOptions options = {}, int messages = 24) {
    McapWriter writer(std::move(options));
    const auto scans = writer.connect("/scan", "sensor_msgs/msg/LaserScan");
    const auto odometry = writer.connect("/odom", "nav_msgs/msg/Odometry");
    for (int i = 0; i < messages; ++i) {
        const auto size = static_cast<std::size_t>(i * 11 % 43);
        writer.write(i % 3 == 0 ? scans : odometry, 1'700'000'000'500'000'000 + std::int64_t{i} * 100'000'000,
                     fmt::format("{:>{}}", i, size + 2));
    }
    return writer.finish();
}

} // namespace scanloom::testing_support
