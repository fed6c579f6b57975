#pragma once

#include "tests/support/written_recording.hpp"

#include <fmt/format.h>

#include <map>

/// Writes ROS 1 bags of format 2.0 for tests.
namespace scanloom::testing_support {

struct BagOptions {
    std::string compression = "none";
    std::size_t chunk_bytes = 400;      ///< a chunk ends once it has so many
    bool is_closed = true;              ///< false: as a recorder that crashed leaves it, without an index
    bool has_sizes = true;              ///< false: the last chunk has no sizes, as such a recorder leaves it
    std::size_t index_entry_bytes = 12; ///< 20: as the lengths of a bag of 2010 say, whose entries have 12 all the same
    bool has_inner_topics = true;       ///< whether the topic is repeated in the data of connections
};

class BagWriter {
public:
    explicit BagWriter(BagOptions options = {}) : options_(std::move(options)) {
        recording_.file = "#ROSBAG V2.0\n" + std::string(kBagHeaderBytes, ' ');
    }

    /// @return the connection's number
    std::uint32_t connect(const std::string& topic, const std::string& type, const std::string& md5sum = "0") {
        std::string data;
        if (options_.has_inner_topics) append_field(data, "topic", topic);
        append_field(data, "type", type);
        append_field(data, "md5sum", md5sum);
        append_field(data, "message_definition", "uint8 x\n");
        const auto number = static_cast<std::uint32_t>(connections_.size());
        std::string header;
        append_field(header, "op", "\x07");
        append_field(header, "conn", little(number));
        append_field(header, "topic", topic);
        connections_.push_back({topic, record(header, data), false});
        return number;
    }

    void write(std::uint32_t connection, std::int64_t time, const std::string& bytes) {
        Connection& it = connections_.at(connection);
        if (!it.is_written) {
            descriptions_.push_back({chunk_.size(), chunk_.size() + it.record.size(), it.topic});
            chunk_ += it.record;
            it.is_written = true;
        }
        index_[connection].emplace_back(time, chunk_.size());
        const std::size_t begin = chunk_.size();
        chunk_ += message_record(connection, time, bytes);
        messages_.push_back({it.topic, time, bytes, begin, chunk_.size()});
        if (chunk_.size() >= options_.chunk_bytes) end_chunk();
    }

    /// Writes bytes between two chunks.
    void write_raw(std::string_view bytes) {
        end_chunk();
        recording_.file += bytes;
    }

    /// Returns the record of a message.
    [[nodiscard]] static std::string message_record(std::uint32_t connection, std::int64_t time,
                                                    const std::string& bytes) {
        std::string header;
        append_field(header, "op", "\x02");
        append_field(header, "conn", little(connection));
        append_field(header, "time", bag_time(time));
        return record(header, bytes);
    }

    void end_chunk(bool has_sizes = true) {
        if (chunk_.empty()) return;
        const std::string packed = compressed(options_.compression, chunk_);
        std::string header;
        append_field(header, "op", "\x05");
        append_field(header, "compression", options_.compression);
        append_field(header, "size", little(static_cast<std::uint32_t>(has_sizes ? chunk_.size() : 0)));
        const std::size_t begin = recording_.file.size();
        std::string all = record(header, packed);
        const std::size_t data = begin + all.size() - packed.size();
        if (!has_sizes) all.replace(all.size() - packed.size() - 4, 4, 4, '\0');
        recording_.file += all;
        const bool is_plain = options_.compression == "none";
        for (auto& message : messages_) {
            message.begin = is_plain ? data + message.begin : begin;
            message.end = is_plain ? data + message.end : recording_.file.size();
            recording_.messages.push_back(message);
        }
        for (auto& part : descriptions_) {
            if (is_plain) recording_.descriptions.push_back({data + part.begin, data + part.end, part.topic});
        }
        for (const auto& [connection, entries] : index_) {
            std::string data_of_index;
            for (const auto& [time, offset] : entries) {
                data_of_index += bag_time(time) + little(static_cast<std::uint32_t>(offset));
            }
            std::string index_header;
            append_field(index_header, "op", "\x04");
            append_field(index_header, "ver", little(std::uint32_t{1}));
            append_field(index_header, "conn", little(connection));
            append_field(index_header, "count", little(static_cast<std::uint32_t>(entries.size())));
            append_counted(recording_.file, index_header);
            append_little(recording_.file, static_cast<std::uint32_t>(options_.index_entry_bytes * entries.size()));
            recording_.file += data_of_index;
        }
        chunks_.push_back({begin, index_, messages_});
        chunk_.clear();
        index_.clear();
        messages_.clear();
        descriptions_.clear();
    }

    /// Ends the bag. @return the file, and where its messages are
    [[nodiscard]] WrittenRecording finish() {
        end_chunk(options_.has_sizes);
        const std::uint64_t index_begin = options_.is_closed ? recording_.file.size() : 0;
        std::string header;
        append_field(header, "op", "\x03");
        append_field(header, "index_pos", little(index_begin));
        append_field(header, "conn_count", little(static_cast<std::uint32_t>(connections_.size())));
        append_field(header, "chunk_count", little(static_cast<std::uint32_t>(chunks_.size())));
        const std::string start = record(header, std::string(kBagHeaderBytes - 8 - header.size(), ' '));
        recording_.file.replace(kMagicBytes, kBagHeaderBytes, start);
        if (!options_.is_closed) return recording_;
        for (const auto& connection : connections_) recording_.file += connection.record;
        for (const auto& chunk : chunks_) recording_.file += chunk_info(chunk);
        return recording_;
    }

private:
    static constexpr std::size_t kMagicBytes = 13;
    static constexpr std::size_t kBagHeaderBytes = 4096;

    struct Connection {
        std::string topic;
        std::string record;
        bool is_written = false;
    };

    using Index = std::map<std::uint32_t, std::vector<std::pair<std::int64_t, std::size_t>>>;

    struct WrittenChunk {
        std::uint64_t begin = 0;
        Index index;
        std::vector<WrittenMessage> messages;
    };

    template <class Integer>
    static std::string little(Integer value) {
        std::string bytes;
        append_little(bytes, value);
        return bytes;
    }

    static std::string bag_time(std::int64_t time) {
        constexpr std::int64_t kSecond = 1'000'000'000;
        return little(static_cast<std::uint32_t>(time / kSecond)) + little(static_cast<std::uint32_t>(time % kSecond));
    }

    static void append_field(std::string& header, std::string_view name, std::string_view value) {
        append_counted(header, std::string(name).append("=").append(value));
    }

    static std::string record(std::string_view header, std::string_view data) {
        std::string bytes;
        append_counted(bytes, header);
        append_counted(bytes, data);
        return bytes;
    }

    static std::string chunk_info(const WrittenChunk& chunk) {
        const auto by_time = [](const auto& a, const auto& b) { return a.time < b.time; };
        const auto [first, last] = std::minmax_element(chunk.messages.begin(), chunk.messages.end(), by_time);
        std::string header;
        append_field(header, "op", "\x06");
        append_field(header, "ver", little(std::uint32_t{1}));
        append_field(header, "chunk_pos", little(chunk.begin));
        append_field(header, "start_time", bag_time(first->time));
        append_field(header, "end_time", bag_time(last->time));
        append_field(header, "count", little(static_cast<std::uint32_t>(chunk.index.size())));
        std::string data;
        for (const auto& [connection, entries] : chunk.index) {
            data += little(connection) + little(static_cast<std::uint32_t>(entries.size()));
        }
        return record(header, data);
    }

    BagOptions options_;
    WrittenRecording recording_;
    std::vector<Connection> connections_;
    std::vector<WrittenChunk> chunks_;
    std::string chunk_; // its records so far
    Index index_;       // of this chunk
    std::vector<WrittenMessage> messages_;
    std::vector<WrittenPart> descriptions_;
};

/// A bag with two topics and messages of various sizes.
inline WrittenRecording small_bag(BagOptions options = {}, int messages = 24) {
    BagWriter writer(std::move(options));
    const auto scans = writer.connect("/scan", "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369");
    const auto odometry = writer.connect("/odom", "nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7");
    for (int i = 0; i < messages; ++i) {
        const auto size = static_cast<std::size_t>(i * 7 % 40);
        writer.write(i % 3 == 0 ? scans : odometry, 1'700'000'000'500'000'000 + std::int64_t{i} * 100'000'000,
                     fmt::format("{:>{}}", i, size + 2));
    }
    return writer.finish();
}

} // namespace scanloom::testing_support
