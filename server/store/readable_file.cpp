#include "server/store/readable_file.hpp"

#include <fmt/format.h>
#include <rocksdb/env.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargePiece = std::size_t{1} << 20;
constexpr std::size_t kSmallPiece = std::size_t{4} << 10; // a page, and the smallest unit that most disks lose

Error unreadable(const fs::path& file, const rocksdb::Status& why) {
    return {Errc::kStoreFailed, fmt::format("cannot read {}: {}; see to its rights, or copy the store to another disk "
                                            "and repair the copy",
                                            file.native(), why.ToString())};
}

/// Reads the readable parts of a piece.
class PieceReader {
public:
    explicit PieceReader(const rocksdb::RandomAccessFile& file) : file_(file) {}

    /// @return number of unreadable bytes, which are set to zero
    std::uint64_t read(std::uint64_t at, char* to, std::size_t bytes) {
        rocksdb::Slice read;
        const bool is_read = file_.Read(at, bytes, &read, to).ok() && read.size() == bytes;
        if (is_read && read.data() != to) std::memcpy(to, read.data(), bytes);
        if (is_read) return 0;
        std::fill_n(to, bytes, '\0');
        if (bytes <= kSmallPiece) return bytes;
        std::uint64_t lost = 0;
        for (std::size_t done = 0; done < bytes; done += kSmallPiece) {
            lost += this->read(at + done, to + done, std::min(kSmallPiece, bytes - done));
        }
        return lost;
    }

private:
    const rocksdb::RandomAccessFile& file_;
};

/// Passes a file to `take` piece by piece.
/// @return number of unreadable bytes
template <typename Take>
Result<std::uint64_t> for_each_piece(const fs::path& path, rocksdb::Env& env, const Take& take) {
    std::uint64_t size = 0;
    std::unique_ptr<rocksdb::RandomAccessFile> file;
    auto status = env.GetFileSize(path.native(), &size);
    if (status.ok()) status = env.NewRandomAccessFile(path.native(), &file, rocksdb::EnvOptions());
    if (!status.ok()) return unreadable(path, status);
    PieceReader reader(*file);
    std::string piece(std::min<std::uint64_t>(size, kLargePiece), '\0');
    std::uint64_t lost = 0;
    for (std::uint64_t at = 0; at < size; at += kLargePiece) {
        piece.resize(std::min<std::uint64_t>(kLargePiece, size - at));
        lost += reader.read(at, piece.data(), piece.size());
        take(piece);
    }
    return lost;
}

} // namespace

Result<ReadableBytes> read_readable(const fs::path& file, rocksdb::Env& env) {
    ReadableBytes read;
    const auto lost = for_each_piece(file, env, [&](const std::string& piece) { read.bytes += piece; });
    if (!lost) return lost.error();
    read.unreadable = *lost;
    return read;
}

Result<std::uint64_t> copy_readable(const fs::path& file, const fs::path& to, rocksdb::Env& env) {
    std::ofstream copy(to, std::ios::binary);
    const auto lost = for_each_piece(file, env, [&](const std::string& piece) { copy << piece; });
    if (!lost) return lost;
    copy.close();
    if (!copy) {
        return Error{Errc::kStoreFailed, fmt::format("cannot write {}; make room on its disk", to.native())};
    }
    return lost;
}

} // namespace scanloom::store
