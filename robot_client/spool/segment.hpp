#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "robot_client/spool/synced_file.hpp"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Returns the CRC-32 (ISO-HDLC, as in gzip) of records and heads in spool files.
[[nodiscard]] inline std::uint32_t checksum(std::string_view bytes) {
    return static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

/// A record in a spool file is `uint32 length, uint32 CRC-32 of the body` (as in zlib; both big-endian), followed by
/// that many bytes of a Frame: a sensor description, or a batch of one scan whose seq is the scan's number within the
/// spool.
inline constexpr std::size_t kRecordHeaderBytes = 8;

void append_record(const wire::Message& message, std::string& out);

struct Record {
    wire::Message message;
    std::size_t bytes = 0; ///< in the file, including the header
};

/// Reads the record at the beginning of `bytes`, or returns nullopt if it is truncated, as the last one is after a
/// power failure.
/// Errors: kMalformed if the bytes are not a record or are damaged.
[[nodiscard]] Result<std::optional<Record>> read_record(std::string_view bytes);

/// Which of a file's scans were sent, and under which seqs. It is kept across restarts of the program, so a scan that
/// was sent is sent again under the same seq.
struct SentAs {
    std::uint64_t from = 0; ///< number within the spool; the scans before it are stored
    std::uint64_t seq = 0;  ///< of that scan on the server; the following scans continue it; 0: none was sent

    friend bool operator==(const SentAs&, const SentAs&) = default;
};

/// A spool file begins with `"SCSPOOL2", uint64 from, uint64 seq, uint32 CRC-32 of both` (big-endian), followed by its
/// records. The head is overwritten in place, which needs no room on a full disk.
inline constexpr std::size_t kSegmentHeadBytes = 28;

[[nodiscard]] std::string segment_head(const SentAs& sent);

/// Returns nullopt if the bytes are not a head or are damaged.
[[nodiscard]] std::optional<SentAs> read_segment_head(std::string_view bytes);

/// Returns when the head is on the disk.
/// Errors: kStoreFailed.
[[nodiscard]] Result<> write_segment_head(const std::filesystem::path& file, const SentAs& sent);

/// Writes one file of the spool.
class SegmentWriter {
public:
    /// Creates a file for the scan numbered `first` and those after it.
    /// Errors: kStoreFailed if the file exists already or cannot be created.
    [[nodiscard]] static Result<SegmentWriter> create(std::filesystem::path file, std::uint64_t first);

    /// Appends all of `bytes` or nothing.
    /// Errors: kStoreFailed. If a partial write could not be undone, all later calls fail, too.
    [[nodiscard]] Result<> append(std::string_view bytes);

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    [[nodiscard]] const std::shared_ptr<const FileDescriptor>& handle() const noexcept { return handle_; }

private:
    SegmentWriter(std::filesystem::path file, FileDescriptor handle)
        : file_(std::move(file)), handle_(std::make_shared<const FileDescriptor>(std::move(handle))) {}

    std::filesystem::path file_;
    std::shared_ptr<const FileDescriptor> handle_; ///< null: no further writes are possible
    std::uint64_t bytes_ = 0;
};

/// Reads one spool file from its beginning, while it may still grow.
class SegmentReader {
public:
    /// Errors: kStoreFailed if it cannot be read.
    [[nodiscard]] static Result<SegmentReader> open(std::filesystem::path file);

    /// Returns the file's head as of open(), or nullopt if it was damaged.
    [[nodiscard]] const std::optional<SentAs>& sent_as() const noexcept { return sent_as_; }

    /// Returns the next record, or nullopt if the file currently ends here or within a record.
    /// Errors: kMalformed if the file is damaged here; the rest cannot be read. kStoreFailed.
    [[nodiscard]] Result<std::optional<Record>> next();

    /// Returns the number of bytes up to the end of the last record read.
    [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

private:
    SegmentReader(std::filesystem::path file, FileDescriptor handle)
        : file_(std::move(file)), handle_(std::move(handle)) {}
    [[nodiscard]] Result<bool> read_more();

    std::filesystem::path file_;
    FileDescriptor handle_;
    std::optional<SentAs> sent_as_;
    std::string buffer_; // bytes read, from position_ on; the first consumed_ of them are records already returned
    std::size_t consumed_ = 0;   // bytes
    std::uint64_t position_ = 0; // of buffer_[consumed_] in the file
};

} // namespace scanloom::robot
