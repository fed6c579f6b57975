#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Recordings of other programs: the messages of ROS 1 bags, MCAP files and rosbag2 databases, front to back.
namespace scanloom::robot {

/// How the bytes of a message represent its fields.
enum class MessageEncoding {
    kRos1,  ///< ROS 1 serialization: little-endian without alignment
    kCdr,   ///< ROS 2: CDR, with four bytes of encapsulation first
    kOther, ///< JSON, Protocol Buffers and others, which this program does not decode
};

/// A topic of a recording. Connections or channels that agree in all three values are one topic.
struct RecordedTopic {
    std::string name; ///< as recorded; ROS 1 nodes of 2010 recorded names without the first "/"
    /// "sensor_msgs/LaserScan": without the "msg/" of ROS 2. Empty if the recording does not say it.
    std::string type;
    MessageEncoding encoding = MessageEncoding::kOther;

    friend bool operator==(const RecordedTopic&, const RecordedTopic&) = default;
};

/// A message as it was recorded.
struct RecordedMessage {
    std::size_t topic = 0; ///< index in Recording::topics()
    /// When it was recorded, in ns since the epoch of the recording; the header of most messages has a better stamp.
    std::int64_t time = 0;
    std::string_view bytes; ///< valid until the next call of Recording::next()
};

/// Bytes of the file, or parts of it, that could not be read.
struct RecordingLoss {
    std::uint64_t offset = 0; ///< in bytes of the file; in a rosbag2 database estimated
    std::string reason;       ///< for people: what is wrong there
};

/// A recording that is read front to back, without its index and in bounded memory: the messages of one chunk, at most
/// kRecordedBytesMax, are held at a time.
///
/// A truncated or damaged recording yields every whole message before and after the damage that can be read; losses()
/// says what could not be read. Reading the same file again yields the same messages.
/// Threads: one at a time.
class Recording {
public:
    virtual ~Recording() = default;

    /// Returns the next message in the order of the file, or nullopt at the end.
    /// Errors: kMalformed if reading the file fails, so that no further message can be read.
    [[nodiscard]] virtual Result<std::optional<RecordedMessage>> next() = 0;

    /// Returns the topics that were seen so far. next() may add topics; it never changes or removes one.
    [[nodiscard]] virtual const std::vector<RecordedTopic>& topics() const = 0;

    /// Returns the first losses, at most kRecordingLossesListed.
    [[nodiscard]] virtual const std::vector<RecordingLoss>& losses() const = 0;

    /// Returns the number of all losses, listed or not.
    [[nodiscard]] virtual std::uint64_t losses_count() const = 0;

    /// Returns how far the file was read, in bytes of the file; in a rosbag2 database estimated.
    [[nodiscard]] virtual ReadProgress progress() const = 0;
};

/// Largest chunk, after decompression, and largest message, in bytes. Of a larger one nothing, or its beginning, is
/// read.
inline constexpr std::size_t kRecordedBytesMax = std::size_t{256} << 20;
/// Number of losses that Recording::losses() lists.
inline constexpr std::size_t kRecordingLossesListed = 100;

/// Formats of recordings.
enum class RecordingFormat {
    kRosbag,  ///< ROS 1 bag, .bag; all its versions, of which open_recording() reads 2.0
    kMcap,    ///< MCAP, .mcap
    kRosbag2, ///< SQLite database of rosbag2, .db3
};

/// Number of a file's first bytes that format_of() needs: a block of zstd, which is decompressed as a whole.
inline constexpr std::size_t kFormatBytes = 132'000;

/// Determines the format of a recording from its content.
/// @param first_bytes  the first kFormatBytes bytes of the file, or the whole file if it is shorter
/// @return nullopt if it is none of the formats. For a file that is compressed as a whole with zstd, the format of the
///         file inside it; open_recording() refuses such a file with a message that says how to decompress it.
[[nodiscard]] std::optional<RecordingFormat> format_of(std::string_view first_bytes);

/// Opens a recording. The content determines its format, not its name.
/// @param path  a file, or the directory of a recording (see parts_in())
/// @return the recording, before its first message
/// Errors: kNotFound if there is no such file or it cannot be opened; kUnsupportedVersion if it has another version of a
///         known format, is encrypted, or is compressed as a whole; the message says what converts it. kMalformed if
///         it is no recording, or reading fails; those of parts_in().
[[nodiscard]] Result<std::unique_ptr<Recording>> open_recording(const std::filesystem::path& path);

} // namespace scanloom::robot
