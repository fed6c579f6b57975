#include "robot_client/sources/line_reader.hpp"

#include "robot_client/sources/unpacked_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>

namespace scanloom::robot {

Tokens split(std::string_view line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    Tokens tokens;
    for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
        tokens.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(kBlanks, end);
    }
    return tokens;
}

std::optional<double> to_number(std::string_view token) {
    double value = 0.0;
    const auto [end, failed] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (end != token.data() + token.size()) return std::nullopt;
    if (failed == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
    if (failed != std::errc{}) return std::nullopt;
    return value;
}

std::string shown_token(std::string_view token) {
    constexpr std::size_t kShownMax = 24;
    std::string text(token.substr(0, kShownMax));
    for (char& c : text) {
        if (c < ' ' || c > '~') c = '?';
    }
    return token.size() > kShownMax ? text + "..." : text;
}

struct LineReader::State {
    State(const std::filesystem::path& name, LineLimits given, OnRead listener)
        : path(name.string()), limits(given), on_read(std::move(listener)), file(name) {
        std::error_code failed; // on failure the total is unknown
        const auto size = std::filesystem::file_size(name, failed);
        if (!failed) bytes_total = size;
    }

    std::string path;
    LineLimits limits;
    OnRead on_read;
    std::uint64_t bytes_total = 0;
    UnpackedFile file;
    std::array<char, 16384> chunk{};
    std::size_t chunk_begin = 0;
    std::size_t chunk_end = 0;
    std::uint64_t text_bytes = 0;
    std::string line;
    std::size_t line_number = 0;

    [[nodiscard]] Error failure(Errc code, std::string_view what) const {
        return {code, fmt::format("{}: {} after line {}", path, what, line_number)};
    }

    [[nodiscard]] Error cannot_unpack() const;

    /// Returns the line that was read completely.
    [[nodiscard]] std::string_view take_line() {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        std::string_view taken = line;
        if (++line_number == 1 && taken.starts_with(kByteOrderMark)) taken.remove_prefix(kByteOrderMark.size());
        return taken;
    }

    /// Fills the empty chunk, or leaves it empty at the end of the text.
    [[nodiscard]] Result<> refill();
};

Error LineReader::State::cannot_unpack() const {
    const bool is_gzip = file.packing() == Packing::kGzip;
    const std::string readable = text_bytes == 0
                                     ? "no text could be read; download the file again"
                                     : fmt::format("only its first {} lines ({} bytes of text) could be read; download "
                                                   "the file again, or unpack them with {} and replay them",
                                                   line_number, text_bytes, is_gzip ? "zcat" : "bzcat");
    return {Errc::kMalformed,
            fmt::format("{}: the {} data is damaged or truncated: {}", path, is_gzip ? "gzip" : "bzip2", readable)};
}

Result<> LineReader::State::refill() {
    const auto count = file.read(chunk);
    if (file.has_failed()) return failure(Errc::kMalformed, "reading failed");
    if (!count) return cannot_unpack();
    chunk_begin = 0;
    chunk_end = *count;
    text_bytes += *count;
    if (on_read) on_read({file.bytes_read(), bytes_total});
    if (text_bytes > limits.text_bytes_max) {
        return failure(Errc::kTooLarge,
                       fmt::format("more than {} bytes of text; split the log", limits.text_bytes_max));
    }
    return {};
}

LineReader::LineReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
LineReader::LineReader(LineReader&&) noexcept = default;
LineReader& LineReader::operator=(LineReader&&) noexcept = default;
LineReader::~LineReader() = default;

Result<LineReader> LineReader::open(const std::filesystem::path& path, LineLimits limits, OnRead on_read) {
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) {
        return Error{Errc::kNotFound, fmt::format("{}: no such file; check the path", path.string())};
    }
    if (!std::filesystem::is_regular_file(path, failed)) {
        return Error{Errc::kNotFound, fmt::format("{}: not a regular file; name a log file", path.string())};
    }
    auto state = std::make_unique<State>(path, limits, std::move(on_read));
    if (!state->file.is_open()) {
        return Error{Errc::kNotFound, fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno))};
    }
    return LineReader(std::move(state));
}

Result<std::optional<std::string_view>> LineReader::next() {
    State& s = *state_;
    s.line.clear();
    for (;;) {
        if (s.chunk_begin == s.chunk_end) {
            if (auto ok = s.refill(); !ok) return ok.error();
            if (s.chunk_end == 0) break;
        }
        const char* begin = s.chunk.data() + s.chunk_begin;
        const std::size_t available = s.chunk_end - s.chunk_begin;
        const auto* newline = static_cast<const char*>(std::memchr(begin, '\n', available));
        const std::size_t taken = newline ? static_cast<std::size_t>(newline - begin) : available;
        s.line.append(begin, taken);
        s.chunk_begin += taken + (newline ? 1 : 0);
        if (s.line.size() > s.limits.line_bytes_max) {
            return s.failure(Errc::kTooLarge,
                             fmt::format("a line of more than {} bytes, not a text log,", s.limits.line_bytes_max));
        }
        if (newline) {
            if (s.line.ends_with('\r')) s.line.pop_back();
            return std::optional(s.take_line());
        }
    }
    if (s.line.empty()) return std::optional<std::string_view>{};
    return std::optional(s.take_line()); // the last line may lack its ending
}

std::size_t LineReader::line_number() const noexcept { return state_->line_number; }

} // namespace scanloom::robot
