#include "server/http/host.hpp"

#include <boost/url/grammar/ci_string.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

#include <algorithm>

namespace scanloom::http {

bool is_known_host(std::string_view host_field, const std::vector<std::string>& names) {
    const auto authority = boost::urls::parse_authority(host_field);
    if (!authority || authority->has_userinfo()) return false;
    if (authority->host_type() != boost::urls::host_type::name) {
        return authority->host_type() != boost::urls::host_type::none;
    }
    const std::string host = authority->host();
    return boost::urls::grammar::ci_is_equal(host, "localhost") ||
           std::ranges::any_of(names, [&](const auto& name) { return boost::urls::grammar::ci_is_equal(host, name); });
}

} // namespace scanloom::http
