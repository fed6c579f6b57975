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
    bool immutable = false;                            ///< its name holds a hash of its content
    std::shared_ptr<const std::string> gzip = nullptr; ///< gzip_of() the content
};

/// The files of the viewer, by path below the folder it was built into: "index.html",
/// "assets/index-BvC3kD9x.js".
using WebFiles = std::map<std::string, WebFile, std::less<>>;

/// Reads index.html and all that lies in assets/ into memory, so that no address ever becomes a path.
/// None when the folder does not exist: the viewer was not built.
/// Errors  kUnreachable: a file cannot be read; kTooLarge: more than 64 MiB.
[[nodiscard]] Result<WebFiles> load_web_files(const std::filesystem::path& folder);

/// Answers with the file of that name; with a page that explains, when there are none at all. A page may ask this
/// server alone, under the name of `host`, the request's Host field: older browsers do not count ws: as the same
/// origin. `is_secure`: it is asked over TLS, and opens its WebSockets so.
/// Errors  kNotFound.
[[nodiscard]] Result<Response> serve_web_file(const WebFiles& files, std::string_view name,
                                              std::string_view if_none_match, std::string_view host,
                                              bool is_secure = false);

} // namespace scanloom::http
