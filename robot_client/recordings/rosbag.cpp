#include "robot_client/recordings/rosbag.hpp"

#include "robot_client/recordings/chunked_recording.hpp"
#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/lz4_tail.hpp"
#include "robot_client/recordings/rosbag_record.hpp"

#include <fmt/format.h>

namespace scanloom::robot {
namespace {

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kFirstLineBytes = 32;                        // enough for that of every version
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

class RosbagRecording final : public ChunkedRecording<BagFormat> {
public:
    explicit RosbagRecording(std::unique_ptr<RecordedBytes> file)
        : ChunkedRecording(std::move(file), kBagMagic.size()) {}

private:
    [[nodiscard]] Taken take(const BagRecord& record, RecordedBytes& bytes) override {
        Result<> ok;
        switch (record.op) {
        case BagOp::kMessage: return take_message(record.connection, record.time, record, bytes);
        case BagOp::kConnection: ok = take_connection(record, bytes); break;
        case BagOp::kChunk:
            if (record.is_packed) ok = take_chunk(record); // else its records follow
            break;
        case BagOp::kBagHeader: index_begin_ = record.index_begin; break;
        case BagOp::kIndex:
        case BagOp::kChunkInfo: break;
        }
        if (!ok) return ok.error();
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] Result<> take_again(const BagRecord& record) override {
        if (record.op != BagOp::kConnection) return {};
        forget(record.connection, true);
        return take_connection(record, *file_);
    }

    [[nodiscard]] Result<std::optional<std::uint64_t>> find_descriptions() override {
        const bool has_index = index_begin_ >= begin_ && index_begin_ < file_->size();
        return has_index ? std::optional(index_begin_) : std::nullopt;
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
        auto name = record.text.empty() ? std::move(connection.topic) : record.text;
        return describe(record.connection, {std::move(name), bag_type(connection), MessageEncoding::kRos1}, record);
    }

    [[nodiscard]] Result<> take_chunk(const BagRecord& record) {
        const auto packed = read_packed(record);
        if (!packed) return packed.error();
        if (!*packed) return {};
        // A recorder writes the size when it ends the chunk; if it crashed before, the size is 0.
        const std::size_t stated = record.unpacked_size == 0 ? kRecordedBytesMax : record.unpacked_size;
        const std::size_t size_max = std::min(stated, kRecordedBytesMax);
        std::size_t taken = 0;
        if (const auto reason = decompress(*record.compression, **packed, size_max, decompressed_, &taken)) {
            const bool is_file_cut = record.end == file_->size() && taken == (*packed)->size();
            if (is_file_cut && record.compression == Compression::kLz4) {
                append_truncated_lz4_block(**packed, size_max, decompressed_);
            }
            lose_rest_of_chunk(record, *reason);
        } else if (record.is_end_unclear) {
            records_.move_to(record.data + taken);
        }
        begin_chunk(record);
        return {};
    }

    void lose_end() override {
        if (index_begin_ == 0) lose_at_end("the recording was not closed: its end may be missing");
        if (index_begin_ <= file_->size()) return;
        lose_at_end(fmt::format("the file is truncated: it had more than {} bytes", index_begin_));
    }

    std::uint64_t index_begin_ = 0;
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
        return Error{
            Errc::kUnsupportedVersion,
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
