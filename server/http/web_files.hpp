#pragma once

#include "common/error/error.hpp"
#include "server/http/response.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace scanloom::http {

/// A file of the viewer.
struct WebFile {
    std::shared_ptr<const std::string> content;
    std::string_view content_type;
    std::string etag;
    bool immutable = false;                            ///< its name contains a hash of its content
    std::shared_ptr<const std::string> gzip = nullptr; ///< gzip_of() the content
};

/// The files of the viewer, by their path relative to the build folder: "index.html", "assets/index-BvC3kD9x.js".
using WebFiles = std::map<std::string, WebFile, std::less<>>;

/// Reads index.html and all files in assets/ into memory, so that a URL is never used as a file path. Returns no files
/// if the folder does not exist because the viewer was not built.
/// Errors: kUnreachable if a file cannot be read; kTooLarge above 64 MiB in total.
[[nodiscard]] Result<WebFiles> load_web_files(const std::filesystem::path& folder);

/// Answers with the file called `name`, or with an explanatory page if there are no files. The page may connect to this
/// server only. Its policy names the WebSocket address explicitly, because older browsers do not treat ws: as the same
/// origin.
/// @param host       the request's Host field
/// @param is_secure  whether the request came over TLS; the page then opens its WebSockets over TLS
/// Errors: kNotFound.
[[nodiscard]] Result<Response> serve_web_file(const WebFiles& files, std::string_view name,
                                              std::string_view if_none_match, std::string_view host,
                                              bool is_secure = false);

} // namespace scanloom::http
