#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <variant>

#include <bzlib.h>
#include <zlib.h>

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

Result<std::vector<double>> read_numbers(std::span<const std::string_view> tokens, std::size_t count,
                                         std::string_view what) {
    if (tokens.size() != count) {
        return Error{Errc::kMalformed, fmt::format("{} values; {} are needed: {}", tokens.size(), count, what)};
    }
    std::vector<double> numbers;
    for (const std::string_view token : tokens) {
        const auto number = to_number(token);
        if (!number) return Error{Errc::kMalformed, fmt::format("'{}' is not a number", shown_token(token))};
        if (!std::isfinite(*number)) {
            return Error{Errc::kInvalidField, fmt::format("'{}' is not finite", shown_token(token))};
        }
        numbers.push_back(*number);
    }
    return numbers;
}

std::string shown_token(std::string_view token) {
    constexpr std::size_t kShownMax = 24;
    std::string text(token.substr(0, kShownMax));
    for (char& c : text) {
        if (c < ' ' || c > '~') c = '?';
    }
    return token.size() > kShownMax ? text + "..." : text;
}

namespace {

enum class Unpacking { kGoesOn, kEnded, kDamaged };

/// One member of a gzip file, which may contain several in sequence.
struct GzipMember {
    z_stream stream{};

    GzipMember() {
        constexpr int kGzipOnly = 16;
        if (inflateInit2(&stream, MAX_WBITS + kGzipOnly) != Z_OK) throw std::bad_alloc();
    }
    GzipMember(const GzipMember&) = delete;
    GzipMember& operator=(const GzipMember&) = delete;
    ~GzipMember() { inflateEnd(&stream); }

    Unpacking step() {
        const int result = inflate(&stream, Z_NO_FLUSH);
        if (result == Z_MEM_ERROR) throw std::bad_alloc();
        if (result == Z_STREAM_END) return Unpacking::kEnded;
        return result == Z_OK || result == Z_BUF_ERROR ? Unpacking::kGoesOn : Unpacking::kDamaged;
    }
};

/// One member of a bzip2 file.
struct Bzip2Member {
    bz_stream stream{};

    Bzip2Member() {
        if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
    }
    Bzip2Member(const Bzip2Member&) = delete;
    Bzip2Member& operator=(const Bzip2Member&) = delete;
    ~Bzip2Member() { BZ2_bzDecompressEnd(&stream); }

    Unpacking step() {
        const int result = BZ2_bzDecompress(&stream);
        if (result == BZ_MEM_ERROR) throw std::bad_alloc();
        if (result == BZ_STREAM_END) return Unpacking::kEnded;
        return result == BZ_OK ? Unpacking::kGoesOn : Unpacking::kDamaged;
    }
};

constexpr std::size_t kFileChunkBytes = 16'384;

/// Reads the bytes of a file, plain or decompressed. Zero bytes after compressed data are padding, as archives and
/// tapes leave it.
class UnpackedFile {
public:
    explicit UnpackedFile(const std::filesystem::path& path) : file_(path, std::ios::binary) {
        std::array<char, 3> first{};
        file_.read(first.data(), first.size());
        const std::string_view known(first.data(), static_cast<std::size_t>(file_.gcount()));
        is_gzip_ = known.starts_with("\x1f\x8b");
        is_plain_ = !is_gzip_ && !known.starts_with("BZh");
        file_.clear();
        file_.seekg(0);
    }

    [[nodiscard]] bool is_open() const { return file_.is_open(); }
    [[nodiscard]] bool is_gzip() const noexcept { return is_gzip_; }
    /// Returns whether the end was reached because reading the file failed.
    [[nodiscard]] bool has_failed() const { return file_.bad(); }
    /// Returns how many bytes of the file itself were read, compressed or not.
    [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }

    /// Fills `text`, which must not be empty, from its beginning. Bytes before damage are returned first.
    /// @return number of bytes, 0 at the end; nullopt if the compressed data are damaged or truncated
    [[nodiscard]] std::optional<std::size_t> read(std::span<char> text) {
        while (!is_damaged_) {
            if (packed_.empty()) refill();
            if (is_plain_) return take(packed_.copy(text.data(), text.size()));
            if (packed_.empty() && is_between_members()) return 0;
            if (is_between_members()) {
                if (!is_first_member_ && packed_.front() == '\0') {
                    is_damaged_ = !only_zeros_are_left();
                    continue;
                }
                is_gzip_ ? void(member_.emplace<GzipMember>()) : void(member_.emplace<Bzip2Member>());
                is_first_member_ = false;
            }
            const std::size_t made =
                is_gzip_ ? unpack(std::get<GzipMember>(member_), text) : unpack(std::get<Bzip2Member>(member_), text);
            if (made > 0) return made;
        }
        return std::nullopt;
    }

private:
    [[nodiscard]] bool is_between_members() const noexcept { return member_.index() == 0; }

    std::size_t take(std::size_t count) {
        packed_.remove_prefix(count);
        return count;
    }

    void refill() {
        file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        packed_ = std::string_view(buffer_.data(), static_cast<std::size_t>(file_.gcount()));
        bytes_read_ += packed_.size();
    }

    bool only_zeros_are_left() {
        for (; !packed_.empty(); refill()) {
            if (packed_.find_first_not_of('\0') != std::string_view::npos) return false;
        }
        return true;
    }

    /// Consumes as much as possible of the packed bytes and fills as much as possible of `text`.
    /// @return number of bytes filled
    template <class Member>
    std::size_t unpack(Member& member, std::span<char> text) {
        auto& stream = member.stream;
        stream.next_in = reinterpret_cast<decltype(stream.next_in)>(const_cast<char*>(packed_.data())); // only read
        stream.avail_in = static_cast<unsigned>(packed_.size());
        stream.next_out = reinterpret_cast<decltype(stream.next_out)>(text.data());
        stream.avail_out = static_cast<unsigned>(text.size());
        const Unpacking state = member.step();
        const std::size_t taken = take(packed_.size() - stream.avail_in);
        const std::size_t made = text.size() - stream.avail_out;
        const bool is_cut_short = taken == 0 && made == 0; // it needs more input and there is none
        is_damaged_ = state == Unpacking::kDamaged || (state == Unpacking::kGoesOn && is_cut_short);
        if (state == Unpacking::kEnded) member_.emplace<std::monostate>();
        return made;
    }

    std::ifstream file_;
    std::array<char, kFileChunkBytes> buffer_{};
    std::string_view packed_; // the remaining part of the buffer
    bool is_gzip_ = false;
    bool is_plain_ = false;
    std::variant<std::monostate, GzipMember, Bzip2Member> member_; // std::monostate between two members
    std::uint64_t bytes_read_ = 0;
    bool is_first_member_ = true;
    bool is_damaged_ = false;
};

} // namespace

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
    std::array<char, kFileChunkBytes> chunk{};
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
    const std::string readable = text_bytes == 0
                                     ? "no text could be read; download the file again"
                                     : fmt::format("only its first {} lines ({} bytes of text) could be read; download "
                                                   "the file again, or unpack them with {} and replay them",
                                                   line_number, text_bytes, file.is_gzip() ? "zcat" : "bzcat");
    return {Errc::kMalformed, fmt::format("{}: the {} data is damaged or truncated: {}", path,
                                          file.is_gzip() ? "gzip" : "bzip2", readable)};
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
