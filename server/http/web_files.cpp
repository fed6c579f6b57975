#include "server/http/web_files.hpp"

#include "server/http/content_coding.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/text.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::size_t kBytesMax = std::size_t{64} << 20;

std::string viewer_policy(std::string_view host, bool is_secure) {
    const auto websockets = websocket_sources(host, is_secure);
    return fmt::format("default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
                       "connect-src 'self'{}{}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
                       websockets.empty() ? "" : " ", websockets);
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kTypes = {{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".wasm", "application/wasm"},
    {".txt", "text/plain; charset=utf-8"},
    {".webmanifest", "application/manifest+json"},
}};

std::string_view type_of(const std::filesystem::path& path) {
    const auto found =
        std::ranges::find(kTypes, path.extension().native(), [](const auto& type) { return type.first; });
    return found == kTypes.end() ? "application/octet-stream" : found->second;
}

/// Vite inserts an eight-character hash before the ending: index-BvC3kD9x.js.
bool has_hash(const std::filesystem::path& path) {
    const std::string stem = path.stem().native();
    constexpr std::size_t kHash = 8;
    if (stem.size() < kHash + 2 || stem[stem.size() - kHash - 1] != '-') return false;
    return std::ranges::all_of(stem.substr(stem.size() - kHash), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    });
}

std::string etag_of(std::string_view content) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    EVP_Digest(content.data(), content.size(), hash.data(), nullptr, EVP_sha256(), nullptr);
    std::string etag = "\"";
    for (std::size_t i = 0; i < 16; ++i) etag += fmt::format("{:02x}", hash[i]);
    return etag += '"';
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string content(std::istreambuf_iterator<char>(file), {});
    if (!file.is_open() || file.bad()) return std::nullopt;
    return content;
}

/// Lists "index.html" and the files in "assets", where the viewer's build places its files.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code ignored; // a missing folder has no files
    if (std::filesystem::is_regular_file(folder / "index.html", ignored)) files.push_back(folder / "index.html");
    for (std::filesystem::directory_iterator entry(folder / "assets", ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    }
    return files;
}

Response not_built() {
    auto response = ok("text/html; charset=utf-8",
                       Body("<!doctype html>\n<html lang=\"en\"><title>Scanloom</title>\n"
                            "<h1>The viewer was not built</h1>\n"
                            "<p>The server runs, but it has no viewer to show. Build it with <code>./scanloom "
                            "build</code>, or name its folder with <code>--web</code>, and start the server "
                            "again.</p>\n<p>The data are there: <a href=\"/api/v1/sessions\">sessions</a>, "
                            "<a href=\"/openapi.json\">description of the API</a>.</p></html>\n"));
    response.set("Cache-Control", kNotKept);
    response.status = Status::not_found;
    return response;
}

} // namespace

Result<WebFiles> load_web_files(const std::filesystem::path& folder) {
    WebFiles files;
    std::size_t total = 0;
    for (const auto& path : files_in(folder)) {
        auto content = read_file(path);
        if (!content) {
            return Error{Errc::kUnreachable,
                         fmt::format("the viewer's file {} cannot be read; check its permissions", path.native())};
        }
        total += content->size();
        if (total > kBytesMax) {
            return Error{
                Errc::kTooLarge,
                fmt::format("the viewer in {} has more than 64 MiB; name its folder with --web", folder.native())};
        }
        const std::string name = path.lexically_relative(folder).generic_string();
        WebFile file{std::make_shared<const std::string>(std::move(*content)), type_of(path)};
        file.etag = etag_of(*file.content);
        file.immutable = name != "index.html" && has_hash(path);
        file.gzip = gzip_of(file.content_type, *file.content);
        files[name] = std::move(file);
    }
    return files;
}

Result<Response> serve_web_file(const WebFiles& files, std::string_view name, std::string_view if_none_match,
                                std::string_view host, bool is_secure) {
    const auto found = files.find(name);
    if (found == files.end()) {
        if (name == "index.html") return not_built();
        return Error{Errc::kNotFound, fmt::format("the viewer has no file {}", in_quotes(name))};
    }
    const WebFile& file = found->second;
    const auto cache_control = file.immutable ? kImmutable : kRevalidate;
    const bool is_known = if_none_match_has(if_none_match, file.etag);
    auto response = is_known ? not_modified(file.etag, cache_control) : ok(file.content_type, Body(file.content));
    if (file.gzip) response.set("Vary", "Accept-Encoding");
    if (!is_known) {
        response.set("ETag", file.etag).set("Cache-Control", cache_control);
        response.gzip = file.gzip;
    }
    // Also for a 304, because a browser applies its fields to the cached page (RFC 9111, section 3.2).
    response.set("Content-Security-Policy", viewer_policy(host, is_secure));
    return response;
}

} // namespace scanloom::http
