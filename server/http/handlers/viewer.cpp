#include "server/http/handlers/viewer.hpp"

namespace scanloom::http {

Result<Response> get_viewer(const WebFiles& files, const Call& call) {
    return serve_web_file(files, "index.html", call.request.if_none_match, call.request.host, call.request.is_secure);
}

Result<Response> get_viewer_asset(const WebFiles& files, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    return serve_web_file(files, "assets/" + call.arguments["file"], call.request.if_none_match, call.request.host,
                          call.request.is_secure);
}

} // namespace scanloom::http
