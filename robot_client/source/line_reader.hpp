#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// How much a reader takes from one file before it gives up.
struct LineLimits {
    std::uint64_t text_bytes_max = std::uint64_t{1} << 30; ///< after decompression
    std::size_t line_bytes_max = std::size_t{1} << 20;
};

/// How far a file has been read; bytes of the file as it is, compressed or not.
struct ReadProgress {
    std::uint64_t bytes = 0;
    std::uint64_t bytes_total = 0;
};
using OnRead = std::function<void(const ReadProgress&)>;

/// The lines of a text file, plain or compressed with gzip or bzip2; its first bytes tell, not its name.
/// Zero bytes behind compressed data are ignored.
///
/// Errors  kNotFound: no such file, or not to be read; kMalformed: damaged or cut short;
///         kTooLarge: beyond the limits. Each names the file and how many whole lines could be read.
/// Thread  one at a time.
class LineReader {
public:
    /// `on_read`, if there is one, hears after every piece of the file how far it has been read.
    [[nodiscard]] static Result<LineReader> open(const std::filesystem::path& path, LineLimits limits = {},
                                                 OnRead on_read = {});

    LineReader(LineReader&&) noexcept;
    LineReader& operator=(LineReader&&) noexcept;
    ~LineReader();

    /// The next line without its ending (LF or CR LF) and without UTF-8's byte order mark before the first, valid until
    /// the next call; nothing after the last one.
    [[nodiscard]] Result<std::optional<std::string_view>> next();

    /// Number of the line that next() gave last, from 1.
    [[nodiscard]] std::size_t line_number() const noexcept;

private:
    struct State;
    explicit LineReader(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

} // namespace scanloom::robot
