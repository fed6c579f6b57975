#include "robot_client/recordings/rosbag.hpp"

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/record_walker.hpp"
#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/recordings/rosbag_record.hpp"

#include <fmt/format.h>

#include <unordered_map>

namespace scanloom::robot {
namespace {

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kFirstLineBytes = 32; // enough for that of every version
constexpr std::size_t kConnectionBytesMax = std::size_t{16} << 20; // with the definition of the message

/// Returns the type of a connection. Some tools record "*" and leave the type to the checksum of its definition.
std::string bag_type(const BagConnection& connection) {
    if (!connection.type.empty() && connection.type != "*") return type_without_msg(connection.type);
    constexpr std::pair<std::string_view, const char*> kTypes[] = {
        {"90c7ef2dc6895d81024acba2ac42f369", "sensor_msgs/LaserScan"},
        {"cd5e73d190d741a2f92e81eda573aca7", "nav_msgs/Odometry"},
        {"94810edda583a504dfda3829e70d7eec", "tf2_msgs/TFMessage"},
        {"3381f2d731d4076ec5c71b0759edbe4e", "nav_msgs/OccupancyGrid"},
    };
    for (const auto& [md5sum, type] : kTypes) {
        if (connection.md5sum == md5sum) return type;
    }
    return {};
}

class RosbagRecording final : public Recording {
public:
    explicit RosbagRecording(std::unique_ptr<RecordedBytes> file)
        : file_(std::move(file)), records_(BagFormat{}, *file_, kBagMagic.size()) {}

    [[nodiscard]] Result<std::optional<RecordedMessage>> next() override {
        for (;;) {
            RecordedBytes& bytes = chunk_ ? static_cast<RecordedBytes&>(chunk_->bytes) : *file_;
            auto step = chunk_ ? chunk_->records.next() : records_.next();
            if (!step) return step.error();
            if (step->gap) lose_gap(*step->gap, bytes);
            if (!step->record) {
                if (!chunk_) return end();
                chunk_.reset();
                continue;
            }
            auto message = take(*step->record, bytes);
            if (!message) return message.error();
            if (*message) return message;
        }
    }

    [[nodiscard]] const std::vector<RecordedTopic>& topics() const override { return topics_.all(); }
    [[nodiscard]] const std::vector<RecordingLoss>& losses() const override { return losses_.listed(); }
    [[nodiscard]] std::uint64_t losses_count() const override { return losses_.count(); }
    [[nodiscard]] ReadProgress progress() const override { return {records_.position(), file_->size()}; }

private:
    using Taken = Result<std::optional<RecordedMessage>>;

    /// The decompressed records of a chunk.
    struct Chunk {
        Chunk(std::string_view decompressed, std::uint64_t begin)
            : bytes(decompressed), records(BagFormat{.is_chunk = true}, bytes, 0), offset(begin) {}

        BytesInMemory bytes;
        RecordWalker<BagFormat> records;
        std::uint64_t offset; ///< of the chunk in the file
    };

    void lose_gap(const RecordGap& gap, const RecordedBytes& bytes) {
        const auto what = fmt::format("{} bytes are damaged or incomplete", gap.end - gap.begin);
        if (!chunk_) return losses_.add(gap.begin, what);
        losses_.add(chunk_->offset,
                    fmt::format("{} of the {} decompressed bytes of a chunk", what, bytes.size()));
    }

    /// Adds a loss in a record: at its place in the file, or at the place of its chunk.
    void lose(const BagRecord& record, std::string reason) {
        losses_.add(chunk_ ? chunk_->offset : record.begin, std::move(reason));
    }

    [[nodiscard]] Taken take(const BagRecord& record, RecordedBytes& bytes) {
        switch (record.op) {
        case BagOp::kMessage: return take_message(record, bytes);
        case BagOp::kConnection:
            if (auto ok = take_connection(record, bytes); !ok) return ok.error();
            break;
        case BagOp::kChunk:
            if (!record.is_packed) break; // its records follow
            if (auto ok = take_chunk(record); !ok) return ok.error();
            break;
        case BagOp::kBagHeader: index_begin_ = record.index_begin; break;
        case BagOp::kIndex:
        case BagOp::kChunkInfo: break;
        }
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] Taken take_message(const BagRecord& record, RecordedBytes& bytes) {
        const auto none = std::optional<RecordedMessage>();
        auto known = connections_.find(record.connection);
        if (known == connections_.end() && !has_read_index_) {
            if (auto ok = read_index(); !ok) return ok.error();
            known = connections_.find(record.connection);
        }
        if (known == connections_.end()) {
            lose(record, fmt::format("a message of connection {}, which is not described", record.connection));
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
        return std::optional(RecordedMessage{known->second, record.time, *data});
    }

    [[nodiscard]] Result<> take_connection(const BagRecord& record, RecordedBytes& bytes) {
        const std::uint64_t size = record.end - record.data;
        if (size > kConnectionBytesMax) {
            lose(record, fmt::format("a connection with {} bytes", size));
            return {};
        }
        auto data = bytes.read(record.data, size);
        if (!data) return data.error();
        auto connection = read_bag_connection(*data);
        // The topic of the record's header is the one of the recording; the other one is that of the publisher.
        auto topic = topics_.add({record.text.empty() ? std::move(connection.topic) : record.text,
                                  bag_type(connection), MessageEncoding::kRos1});
        if (!topic) {
            lose(record, "a topic, because there are too many or its name is too long");
        } else if (const auto known = connections_.try_emplace(record.connection, *topic).first;
                   known->second != *topic) {
            lose(record, fmt::format("a second description of connection {}, which differs", record.connection));
        }
        return {};
    }

    [[nodiscard]] Result<> take_chunk(const BagRecord& record) {
        const std::uint64_t packed_size = record.end - record.data;
        if (packed_size > kRecordedBytesMax) {
            lose(record, fmt::format("a chunk of {} bytes; at most {} are supported", packed_size, kRecordedBytesMax));
            return {};
        }
        auto packed = file_->read(record.data, packed_size);
        if (!packed) return packed.error();
        // A recorder writes the size when it ends the chunk; if it crashed before, the size is 0.
        const std::size_t stated = record.unpacked_size == 0 ? kRecordedBytesMax : record.unpacked_size;
        const std::size_t size_max = std::min(stated, kRecordedBytesMax);
        std::size_t taken = 0;
        if (const auto reason = decompress(*record.compression, *packed, size_max, decompressed_, &taken)) {
            lose(record, fmt::format("a part of a chunk: {}; {} bytes could be decompressed", *reason,
                                     decompressed_.size()));
        } else if (record.is_end_unclear) {
            records_.move_to(record.data + taken);
        }
        chunk_.emplace(decompressed_, record.begin);
        return {};
    }

    /// Reads the connections that are repeated after the last chunk.
    [[nodiscard]] Result<> read_index() {
        has_read_index_ = true;
        if (index_begin_ < kBagMagic.size()) return {};
        RecordWalker<BagFormat> records(BagFormat{}, *file_, index_begin_);
        for (;;) {
            auto step = records.next();
            if (!step) return step.error();
            if (!step->record || step->gap) return {};
            if (step->record->op == BagOp::kConnection) {
                if (auto ok = take_connection(*step->record, *file_); !ok) return ok;
            } else if (step->record->op != BagOp::kChunkInfo) {
                return {};
            }
        }
    }

    [[nodiscard]] Taken end() {
        if (!std::exchange(has_ended_, true)) {
            if (index_begin_ == 0) losses_.add(file_->size(), "the recording was not closed: its end may be missing");
            if (index_begin_ > file_->size()) {
                losses_.add(file_->size(), fmt::format("the file is truncated: it had more than {} bytes", index_begin_));
            }
        }
        return std::optional<RecordedMessage>();
    }

    std::unique_ptr<RecordedBytes> file_;
    RecordWalker<BagFormat> records_;
    std::string decompressed_;
    std::optional<Chunk> chunk_; // while its records are read
    std::unordered_map<std::uint32_t, std::size_t> connections_; // to topics
    TopicList topics_;
    LossList losses_;
    std::uint64_t index_begin_ = 0;
    bool has_read_index_ = false;
    bool has_ended_ = false;
};

} // namespace

bool is_rosbag(std::string_view first_bytes) {
    // Versions before 1.2 began with #ROSLOG.
    return first_bytes.starts_with("#ROSBAG V") || first_bytes.starts_with("#ROSRECORD V") ||
           first_bytes.starts_with("#ROSLOG V");
}

Result<std::unique_ptr<Recording>> open_rosbag(std::unique_ptr<RecordedBytes> file, std::string name) {
    auto first = file->read(0, kFirstLineBytes);
    if (!first) return first.error();
    if (first->starts_with("#ROSRECORD V1.2")) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: a ROS bag of format 1.2, of 2010 or earlier; only format 2.0 can be read. Convert "
                                 "it with `rosbag fix OLD.bag NEW.bag` of ROS Kinetic or earlier, because that of ROS "
                                 "Melodic and Noetic fails",
                                 name)};
    }
    if (!first->starts_with(kBagMagic) && is_rosbag(*first)) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: a ROS bag that begins with '{}'; only format 2.0 (#ROSBAG V2.0) can be read. "
                                 "Convert it with the `rosbag` of a ROS version that reads it",
                                 name, shown_word(first->substr(0, first->find('\n'))))};
    }
    if (!first->starts_with(kBagMagic)) return Error{Errc::kMalformed, fmt::format("{}: not a ROS bag", name)};
    auto header = BagFormat{}.read(*file, kBagMagic.size());
    if (!header) return header.error();
    const bool is_header = *header && (*header)->op == BagOp::kBagHeader;
    if (is_header && !(*header)->text.empty() && (*header)->text != "rosbag/NoEncryptor") {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: an encrypted ROS bag ({}); decrypt it with `rosbag decrypt`", name,
                                 shown_word((*header)->text))};
    }
    return std::unique_ptr<Recording>(std::make_unique<RosbagRecording>(std::move(file)));
}

} // namespace scanloom::robot
