#include "robot_client/spool/segment_head.hpp"

#include "robot_client/spool/checksum.hpp"
#include "robot_client/spool/file_handle.hpp"

#include <boost/endian/conversion.hpp>
#include <fcntl.h>
#include <unistd.h>

namespace scanloom::robot {
namespace {

constexpr std::string_view kMagic = "SCSPOOL2";
constexpr std::size_t kNumbersBytes = 16;
static_assert(kMagic.size() + kNumbersBytes + 4 == kSegmentHeadBytes);

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

} // namespace

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
    const FileHandle handle(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
    if (!handle) return file_error("cannot open", file);
    if (::pwrite(handle.get(), head.data(), head.size(), 0) != static_cast<ssize_t>(head.size()) ||
        ::fdatasync(handle.get()) != 0) {
        return file_error("cannot write", file);
    }
    return {};
}

} // namespace scanloom::robot
