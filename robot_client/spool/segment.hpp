#pragma once

#include "common/error/error.hpp"
#include "robot_client/spool/file_handle.hpp"
#include "robot_client/spool/record.hpp"
#include "robot_client/spool/segment_head.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Writes one file of the spool.
class SegmentWriter {
public:
    /// Of the scan `first` and those that follow. Errors  kStoreFailed: it exists already, or cannot be made.
    [[nodiscard]] static Result<SegmentWriter> create(std::filesystem::path file, std::uint64_t first);

    /// Appends all of `bytes`, or nothing of them.
    /// Errors  kStoreFailed, and nothing can be appended any more where not even that could be taken back.
    [[nodiscard]] Result<> append(std::string_view bytes);

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
    [[nodiscard]] const std::shared_ptr<const FileHandle>& handle() const noexcept { return handle_; }

private:
    SegmentWriter(std::filesystem::path file, FileHandle handle)
        : file_(std::move(file)), handle_(std::make_shared<const FileHandle>(std::move(handle))) {}

    std::filesystem::path file_;
    std::shared_ptr<const FileHandle> handle_; ///< null: nothing can be appended any more
    std::uint64_t bytes_ = 0;
};

/// Reads one file of the spool from its beginning, while it may still grow.
class SegmentReader {
public:
    /// Errors  kStoreFailed: it cannot be read.
    [[nodiscard]] static Result<SegmentReader> open(std::filesystem::path file);

    /// What its head said when it was opened; nothing where that is damaged.
    [[nodiscard]] const std::optional<SentAs>& sent_as() const noexcept { return sent_as_; }

    /// The next record; nothing where the file ends by now, or within a record.
    /// Errors  kMalformed: damage, and what follows cannot be read; kStoreFailed.
    [[nodiscard]] Result<std::optional<Record>> next();

    /// Bytes up to the end of the last record that was read.
    [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

private:
    SegmentReader(std::filesystem::path file, FileHandle handle) : file_(std::move(file)), handle_(std::move(handle)) {}
    [[nodiscard]] Result<bool> read_more();

    std::filesystem::path file_;
    FileHandle handle_;
    std::optional<SentAs> sent_as_;
    std::string buffer_;         // read, from position_ on; consumed_ of it are records already read
    std::size_t consumed_ = 0;   // bytes
    std::uint64_t position_ = 0; // of buffer_[consumed_] in the file
};

} // namespace scanloom::robot
