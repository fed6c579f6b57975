#include "robot_client/source/line_reader.hpp"

#include <boost/iostreams/filter/bzip2.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filtering_streambuf.hpp>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace scanloom::robot {
namespace {

namespace io = boost::iostreams;

enum class Packing { kPlain, kGzip, kBzip2 };

/// Unpacked at a time: of what stands before damaged data not much more than that is lost.
constexpr std::streamsize kUnpackBytes = 4096;

Packing packing_of(std::istream& file) {
    std::array<char, 3> magic{};
    file.read(magic.data(), magic.size());
    file.clear();
    file.seekg(0);
    if (magic[0] == '\x1f' && magic[1] == '\x8b') return Packing::kGzip;
    if (magic == std::array{'B', 'Z', 'h'}) return Packing::kBzip2;
    return Packing::kPlain;
}

} // namespace

struct LineReader::State {
    std::string path;
    LineLimits limits;
    Packing packing = Packing::kPlain;
    std::ifstream file;
    io::filtering_streambuf<io::input> text;
    std::array<char, kUnpackBytes> chunk{};
    std::size_t chunk_begin = 0;
    std::size_t chunk_end = 0;
    std::uint64_t text_bytes = 0;
    std::string line;
    std::size_t line_number = 0;

    [[nodiscard]] Error failure(Errc code, std::string_view what) const {
        return {code, fmt::format("{}: {} after line {}", path, what, line_number)};
    }

    [[nodiscard]] Error cannot_unpack() const;

    /// Fills the empty chunk; leaves it empty at the end of the text.
    [[nodiscard]] Result<> refill();
};

/// What Boost.Iostreams says ("bzip2 error") helps nobody.
Error LineReader::State::cannot_unpack() const {
    const bool is_gzip = packing == Packing::kGzip;
    const std::string readable =
        text_bytes == 0
            ? "nothing of it could be read; get the file again"
            : fmt::format("only its first {} lines ({} bytes of text) could be read; get the file again, or "
                          "unpack those with {} and replay them",
                          line_number, text_bytes, is_gzip ? "zcat" : "bzcat");
    return {Errc::kMalformed,
            fmt::format("{}: the {} data is damaged or cut short: {}", path, is_gzip ? "gzip" : "bzip2", readable)};
}

Result<> LineReader::State::refill() {
    chunk_begin = chunk_end = 0;
    try {
        const std::streamsize count = text.sgetn(chunk.data(), static_cast<std::streamsize>(chunk.size()));
        if (count > 0) chunk_end = static_cast<std::size_t>(count);
    } catch (const std::exception&) {
        return cannot_unpack();
    }
    if (file.bad()) return failure(Errc::kMalformed, "reading failed");
    text_bytes += chunk_end;
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

Result<LineReader> LineReader::open(const std::filesystem::path& path, LineLimits limits) {
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) {
        return Error{Errc::kNotFound, fmt::format("{}: no such file; check the path", path.string())};
    }
    if (!std::filesystem::is_regular_file(path, failed)) {
        return Error{Errc::kNotFound, fmt::format("{}: not a regular file; name a log file", path.string())};
    }
    auto state = std::make_unique<State>();
    state->path = path.string();
    state->limits = limits;
    state->file.open(path, std::ios::binary);
    if (!state->file) {
        return Error{Errc::kNotFound, fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno))};
    }
    state->packing = packing_of(state->file);
    if (state->packing == Packing::kGzip) state->text.push(io::gzip_decompressor(), kUnpackBytes);
    if (state->packing == Packing::kBzip2) state->text.push(io::bzip2_decompressor(), kUnpackBytes);
    state->text.push(*state->file.rdbuf());
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
            ++s.line_number;
            return std::optional<std::string_view>(s.line);
        }
    }
    if (s.line.empty()) return std::optional<std::string_view>{};
    ++s.line_number; // the last line may lack its ending
    return std::optional<std::string_view>(s.line);
}

std::size_t LineReader::line_number() const noexcept { return state_->line_number; }

} // namespace scanloom::robot
