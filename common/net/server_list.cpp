#include "common/net/server_list.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::net {

bool ServerList::choose_another(std::string_view address) {
    auto named = parse_address(address);
    if (named && redirects_ < kRedirectsMax) {
        ++redirects_;
        wait_max_ = kShort;
        sent_to_ = std::move(*named);
        return true;
    }
    redirects_ = 0;
    if (!sent_to_)
        next_ = (next_ + 1) % servers_.size(); // otherwise the one that sent the client elsewhere is tried again
    sent_to_.reset();
    return false;
}

std::string ServerList::text() const {
    std::string text;
    for (const Address& server : servers_) text += (text.empty() ? "" : ",") + server.text();
    return text;
}

Result<std::vector<Address>> parse_addresses(std::string_view text) {
    std::vector<Address> addresses;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(',', begin), text.size());
        auto address = parse_address(text.substr(begin, end - begin));
        if (!address) return address.error();
        addresses.push_back(std::move(*address));
        begin = end + 1;
    }
    return addresses;
}

} // namespace scanloom::net
