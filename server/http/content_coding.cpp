#include "server/http/content_coding.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace scanloom::http {
namespace {

/// A shorter text fits into one packet without compression.
constexpr std::size_t kBytesMin = 1400;

constexpr int kLevel = 1;            // of 9: compresses the table of a map to a twentieth at 2 ms per megabyte
constexpr int kGzipWindow = 15 + 16; // zlib: largest window, with a gzip header
constexpr int kMemoryLevel = 8;      // zlib's default
constexpr std::string_view kBlank = " \t";

std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
    return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

bool is_same_word(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return (x | 0x20) == (y | 0x20); });
}

/// Removes the text before the next separator and the separator from the front, and returns that text.
std::string_view take_until(std::string_view& text, char separator) {
    const auto end = std::min(text.find(separator), text.size());
    const auto taken = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    return taken;
}

/// Returns the weight in "q=0.5", or nullopt if the parameter is not a weight.
std::optional<double> weight_of(std::string_view parameter) {
    if (!parameter.starts_with("q=") && !parameter.starts_with("Q=")) return std::nullopt;
    const auto digits = parameter.substr(2);
    double weight = 0.0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), weight, std::chars_format::fixed);
    if (error != std::errc{} || end != digits.data() + digits.size() || !(weight >= 0.0 && weight <= 1.0)) {
        return std::nullopt;
    }
    return weight;
}

bool is_text(std::string_view content_type) {
    constexpr std::array kApplications = {"application/json",       "application/geo+json", "application/problem+json",
                                          "application/javascript", "image/svg+xml",        "model/ply"};
    const auto type = trimmed(content_type.substr(0, content_type.find(';')));
    return type.starts_with("text/") || std::ranges::find(kApplications, type) != kApplications.end();
}

} // namespace

bool accepts_gzip(std::string_view field) {
    std::optional<double> of_gzip;
    std::optional<double> of_others;
    while (!field.empty()) {
        auto element = take_until(field, ',');
        if (element.empty()) continue; // lists may contain empty elements
        const auto coding = take_until(element, ';');
        std::optional<double> weight = 1.0;
        if (!element.empty()) weight = weight_of(trimmed(element));
        if (!weight) return false;
        if (is_same_word(coding, "gzip") || is_same_word(coding, "x-gzip")) of_gzip = weight;
        if (coding == "*") of_others = weight;
    }
    return of_gzip.value_or(of_others.value_or(0.0)) > 0.0;
}

Result<std::string> gzipped(std::string_view text) {
    const Error no_memory{Errc::kOverloaded, "there is no memory left to compress the answer; try again later"};
    z_stream stream{};
    if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzipWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
        return no_memory;
    }
    std::string compressed(deflateBound(&stream, text.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
    stream.avail_out = static_cast<uInt>(compressed.size());
    const int ended = deflate(&stream, Z_FINISH);
    compressed.resize(stream.total_out);
    deflateEnd(&stream);
    if (ended != Z_STREAM_END) return no_memory;
    compressed.shrink_to_fit();
    return compressed;
}

std::shared_ptr<const std::string> gzip_of(std::string_view content_type, std::string_view text) {
    if (text.size() < kBytesMin || !is_text(content_type)) return nullptr;
    auto compressed = gzipped(text);
    if (!compressed || compressed->size() >= text.size()) return nullptr;
    return std::make_shared<const std::string>(std::move(*compressed));
}

Response encoded_for(std::string_view accept_encoding, Response response) {
    const auto text = response.body.bytes();
    if (response.stream || text.size() < kBytesMin || !is_text(response.get("Content-Type"))) return response;
    response.set("Vary", "Accept-Encoding");
    if (!accepts_gzip(accept_encoding)) return response;
    const auto compressed = response.gzip ? response.gzip : gzip_of(response.get("Content-Type"), text);
    if (!compressed) return response;
    response.body = Body(compressed);
    response.set("Content-Encoding", "gzip");
    for (auto& [field, value] : response.fields) {
        if (field == "ETag" && !value.starts_with("W/")) value.insert(0, "W/");
    }
    return response;
}

} // namespace scanloom::http
