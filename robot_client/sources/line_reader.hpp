#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The words and numbers of text recordings.
namespace scanloom::robot {

using Tokens = std::vector<std::string_view>;

/// Splits a line at blanks.
[[nodiscard]] Tokens split(std::string_view line);

/// Converts a whole token to a number; one too large for a double becomes infinite.
[[nodiscard]] std::optional<double> to_number(std::string_view token);

/// Converts the tokens of a line to finite numbers.
/// @param what  names the numbers in messages
/// Errors: kMalformed if there are not `count` tokens or one is not a number; kInvalidField if one is not finite.
[[nodiscard]] Result<std::vector<double>> read_numbers(std::span<const std::string_view> tokens, std::size_t count,
                                                       std::string_view what);

/// Returns a token for messages: shortened, and without characters that a terminal could interpret.
[[nodiscard]] std::string shown_token(std::string_view token);

/// Limits of a reader for one file.
struct LineLimits {
    std::uint64_t text_bytes_max = std::uint64_t{1} << 30; ///< after decompression
    std::size_t line_bytes_max = std::size_t{1} << 20;
};

/// A line that could not be used, and the reason.
struct SkippedLine {
    std::size_t line_number = 0;
    std::string reason;
};

/// How far a file has been read, in bytes of the file as it is, compressed or not.
struct ReadProgress {
    std::uint64_t bytes = 0;
    std::uint64_t bytes_total = 0;
};
using OnRead = std::function<void(const ReadProgress&)>;

/// Reads the lines of a text file, plain or compressed with gzip or bzip2. The first bytes of the file determine its
/// format, not its name. Zero bytes after compressed data are ignored.
///
/// Errors: kNotFound if the file does not exist or cannot be read; kMalformed if it is damaged or truncated; kTooLarge
///         if it exceeds the limits. Each names the file and how many complete lines could be read.
/// Threads: one at a time.
class LineReader {
public:
    /// @param on_read  if not empty, called after each chunk of the file with the progress
    [[nodiscard]] static Result<LineReader> open(const std::filesystem::path& path, LineLimits limits = {},
                                                 OnRead on_read = {});

    LineReader(LineReader&&) noexcept;
    LineReader& operator=(LineReader&&) noexcept;
    ~LineReader();

    /// Returns the next line, or nullopt after the last one. Line endings (LF or CR LF) and a UTF-8 byte order mark
    /// before the first line are removed. The text is valid until the next call.
    [[nodiscard]] Result<std::optional<std::string_view>> next();

    /// Returns the number of the line that next() returned last, from 1.
    [[nodiscard]] std::size_t line_number() const noexcept;

private:
    struct State;
    explicit LineReader(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

} // namespace scanloom::robot
