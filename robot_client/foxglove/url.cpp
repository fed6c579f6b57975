#include "robot_client/foxglove/url.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::robot {

Result<Url> parse_url(std::string_view text, const UrlForm& form) {
    const Error other_form{Errc::kInvalidField,
                           fmt::format("'{}' is not {}HOST:PORT or {}HOST:PORT", text, form.plain, form.encrypted)};
    Url url;
    url.text = text;
    url.is_encrypted = text.starts_with(form.encrypted);
    if (!url.is_encrypted && !text.starts_with(form.plain)) return other_form;
    text.remove_prefix(url.is_encrypted ? form.encrypted.size() : form.plain.size());
    const bool has_blank = std::ranges::any_of(text, [](char c) { return c <= ' ' || c > '~'; });
    const auto path = std::min(text.find_first_of("/?#"), text.size());
    std::string place(text.substr(0, path));
    if (has_blank || place.empty() || place.find('@') != std::string::npos) return other_form;
    const bool has_port = place.back() != ']' && place.find(':') != std::string::npos;
    if (!has_port) place.append(":").append(form.default_port);
    auto address = net::parse_address(place);
    if (!address) return other_form;
    url.address = std::move(*address);
    url.target = text.substr(path, text.find('#') - path);
    if (!url.target.starts_with('/')) url.target.insert(0, "/");
    return url;
}

} // namespace scanloom::robot
