#include "robot_client/spool/segment.hpp"

#include "common/wire/frame_decoder.hpp"
#include "robot_client/spool/synced_file.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::robot {
namespace {

constexpr std::string_view kMagic = "SCSPOOL2";
constexpr std::size_t kNumbersBytes = 16;
static_assert(kMagic.size() + kNumbersBytes + 4 == kSegmentHeadBytes);

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

} // namespace

void append_record(const wire::Message& message, std::string& out) {
    std::string frame;
    wire::encode(message, frame);
    const std::string_view body = std::string_view(frame).substr(wire::kLengthPrefixBytes);
    unsigned char header[kRecordHeaderBytes];
    boost::endian::store_big_u32(header, static_cast<std::uint32_t>(body.size()));
    boost::endian::store_big_u32(header + 4, checksum(body));
    out.append(reinterpret_cast<const char*>(header), sizeof header);
    out.append(body);
}

Result<std::optional<Record>> read_record(std::string_view bytes) {
    if (bytes.size() < kRecordHeaderBytes) return std::optional<Record>{};
    const std::uint32_t length = boost::endian::load_big_u32(bytes_of(bytes));
    if (length == 0 || length > wire::kFrameBytesMax) return Error{Errc::kMalformed, "a record has an invalid length"};
    if (bytes.size() < kRecordHeaderBytes + length) return std::optional<Record>{};
    const std::string_view body = bytes.substr(kRecordHeaderBytes, length);
    if (boost::endian::load_big_u32(bytes_of(bytes) + 4) != checksum(body))
        return Error{Errc::kMalformed, "a record's checksum does not match"};
    auto message = wire::decode(body);
    if (!message) return message.error();
    return std::optional(Record{std::move(*message), kRecordHeaderBytes + length});
}

std::string segment_head(const SentAs& sent) {
    unsigned char numbers[kNumbersBytes + 4];
    boost::endian::store_big_u64(numbers, sent.from);
    boost::endian::store_big_u64(numbers + 8, sent.seq);
    boost::endian::store_big_u32(numbers + kNumbersBytes,
                                 checksum({reinterpret_cast<const char*>(numbers), kNumbersBytes}));
    return std::string(kMagic).append(reinterpret_cast<const char*>(numbers), sizeof numbers);
}

std::optional<SentAs> read_segment_head(std::string_view bytes) {
    if (bytes.size() < kSegmentHeadBytes || !bytes.starts_with(kMagic)) return std::nullopt;
    const std::string_view numbers = bytes.substr(kMagic.size(), kNumbersBytes);
    const auto sum = boost::endian::load_big_u32(bytes_of(bytes) + kMagic.size() + kNumbersBytes);
    if (sum != checksum(numbers)) return std::nullopt;
    return SentAs{boost::endian::load_big_u64(bytes_of(numbers)), boost::endian::load_big_u64(bytes_of(numbers) + 8)};
}

Result<> write_segment_head(const std::filesystem::path& file, const SentAs& sent) {
    const std::string head = segment_head(sent);
    const FileDescriptor handle(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
    if (!handle) return file_error("cannot open", file);
    if (::pwrite(handle.get(), head.data(), head.size(), 0) != static_cast<ssize_t>(head.size()) ||
        ::fdatasync(handle.get()) != 0) {
        return file_error("cannot write", file);
    }
    return {};
}

namespace {

constexpr std::size_t kReadBytes = std::size_t{32} << 10;

} // namespace

Result<SegmentWriter> SegmentWriter::create(std::filesystem::path file, std::uint64_t first) {
    FileDescriptor handle(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644));
    if (!handle) return file_error("cannot create", file);
    SegmentWriter writer(std::move(file), std::move(handle));
    if (auto ok = writer.append(segment_head({first, 0})); !ok) {
        ::unlink(writer.file_.c_str());
        return ok.error();
    }
    return writer;
}

Result<> SegmentWriter::append(std::string_view bytes) {
    if (!handle_) return Error{Errc::kStoreFailed, fmt::format("{} can no longer be written", file_.string())};
    std::size_t written = 0;
    while (written < bytes.size()) {
        const ssize_t count = ::write(handle_->get(), bytes.data() + written, bytes.size() - written);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            Error failed = file_error("cannot write", file_);
            if (::ftruncate(handle_->get(), static_cast<off_t>(bytes_)) != 0) handle_.reset();
            return failed;
        }
        written += static_cast<std::size_t>(count);
    }
    bytes_ += bytes.size();
    return {};
}

Result<SegmentReader> SegmentReader::open(std::filesystem::path file) {
    FileDescriptor handle(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!handle) return file_error("cannot open", file);
    SegmentReader reader(std::move(file), std::move(handle));
    while (reader.buffer_.size() < kSegmentHeadBytes) {
        const auto more = reader.read_more();
        if (!more) return more.error();
        if (!*more) break;
    }
    reader.sent_as_ = read_segment_head(reader.buffer_);
    reader.consumed_ = std::min(kSegmentHeadBytes, reader.buffer_.size());
    reader.position_ = reader.consumed_;
    return reader;
}

Result<std::optional<Record>> SegmentReader::next() {
    for (;;) {
        auto record = read_record(std::string_view(buffer_).substr(consumed_));
        if (!record) {
            return prefixed(fmt::format("{} is damaged after {} bytes: ", file_.string(), position_), record.error());
        }
        if (*record) {
            consumed_ += (*record)->bytes;
            position_ += (*record)->bytes;
            return record;
        }
        const auto more = read_more();
        if (!more) return more.error();
        if (!*more) return std::optional<Record>{};
    }
}

/// @return whether more bytes were read
Result<bool> SegmentReader::read_more() {
    buffer_.erase(0, consumed_);
    consumed_ = 0;
    const std::size_t held = buffer_.size();
    buffer_.resize(held + kReadBytes);
    ssize_t count = -1;
    do {
        count = ::read(handle_.get(), buffer_.data() + held, kReadBytes);
    } while (count < 0 && errno == EINTR);
    buffer_.resize(held + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count < 0) return file_error("cannot read", file_);
    return count > 0;
}

} // namespace scanloom::robot
