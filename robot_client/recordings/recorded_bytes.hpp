#pragma once

#include "common/error/error.hpp"
#include "common/files/file_descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Bytes that records are read from: those of a file, or of a decompressed chunk.
class RecordedBytes {
public:
    virtual ~RecordedBytes() = default;

    /// Returns the number of bytes.
    [[nodiscard]] virtual std::uint64_t size() const = 0;

    /// Returns `count` bytes at `offset`, fewer at the end. They are valid until the next call of read().
    /// Errors: kMalformed if reading the file fails.
    [[nodiscard]] virtual Result<std::string_view> read(std::uint64_t offset, std::size_t count) = 0;

    /// Does the same for a few bytes, at most kPeekBytesMax, anywhere in the file. They are valid until the next call of
    /// read() or peek(); what read() returned remains valid.
    [[nodiscard]] virtual Result<std::string_view> peek(std::uint64_t offset, std::size_t count) = 0;
};

inline constexpr std::size_t kPeekBytesMax = 8192;

/// Bytes in memory.
class BytesInMemory final : public RecordedBytes {
public:
    /// @param bytes  must outlive this object
    explicit BytesInMemory(std::string_view bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
    [[nodiscard]] Result<std::string_view> read(std::uint64_t offset, std::size_t count) override {
        return offset < bytes_.size() ? bytes_.substr(offset, count) : std::string_view();
    }
    [[nodiscard]] Result<std::string_view> peek(std::uint64_t offset, std::size_t count) override {
        return read(offset, count);
    }

private:
    std::string_view bytes_;
};

/// Bytes of a file, which is read in windows. A file that grows is read up to its size when it was opened.
class BytesOfFile final : public RecordedBytes {
public:
    /// Errors: kNotFound if there is no such file or it cannot be opened.
    [[nodiscard]] static Result<std::unique_ptr<BytesOfFile>> open(const std::filesystem::path& path);

    [[nodiscard]] std::uint64_t size() const override { return size_; }
    [[nodiscard]] Result<std::string_view> read(std::uint64_t offset, std::size_t count) override;
    [[nodiscard]] Result<std::string_view> peek(std::uint64_t offset, std::size_t count) override;

private:
    BytesOfFile(std::string path, FileDescriptor file, std::uint64_t size);

    /// Replaces `bytes` by bytes of the file.
    [[nodiscard]] Result<> fill(std::string& bytes, std::uint64_t offset, std::size_t count) const;

    std::string path_;
    FileDescriptor file_;
    std::uint64_t size_;
    std::string window_;
    std::uint64_t window_begin_ = 0;
    std::string peeked_;
};

} // namespace scanloom::robot
