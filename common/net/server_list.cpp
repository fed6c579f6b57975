#include "common/net/server_list.hpp"

#include "common/hash/sha256.hpp"

#include <boost/algorithm/string/trim.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace scanloom::net {
namespace {

/// Returns the numbers of the servers in the order in which a session tries them: by the SHA-256 of the session's name,
/// a line feed and the server's address. The client for Python has the same order.
std::vector<std::size_t> order_for(std::string_view session, const std::vector<Address>& servers) {
    std::multimap<std::string, std::size_t> by_hash;
    for (const Address& server : servers) {
        Sha256 hash;
        hash.update(fmt::format("{}\n{}", session, server.text()));
        by_hash.emplace(hash.hex(), by_hash.size());
    }
    std::vector<std::size_t> order;
    for (const auto& [hash, number] : by_hash) order.push_back(number);
    return order;
}

} // namespace

ServerList::ServerList(std::vector<Address> servers, std::string_view session)
    : servers_(std::move(servers)), order_(order_for(session, servers_)) {}

bool ServerList::choose_another(std::string_view address) {
    auto named = parse_address(address);
    if (named && redirects_ < kRedirectsMax) {
        ++redirects_;
        wait_max_ = kShort;
        sent_to_ = std::move(*named);
        return true;
    }
    redirects_ = 0;
    if (std::exchange(sent_to_, std::nullopt)) return false; // the one that sent the client there is tried again
    next_ = (next_ + 1) % order_.size();
    tried_ = (tried_ + 1) % order_.size();
    return tried_ != 0;
}

std::string text_of(const std::vector<Address>& addresses) {
    std::string text;
    for (const Address& address : addresses) text += (text.empty() ? "" : ",") + address.text();
    return text;
}

Result<std::vector<Address>> parse_addresses(std::string_view text) {
    std::vector<Address> addresses;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(',', begin), text.size());
        auto address = parse_address(boost::trim_copy(std::string(text.substr(begin, end - begin))));
        if (!address) return address.error();
        addresses.push_back(std::move(*address));
        begin = end + 1;
    }
    return addresses;
}

} // namespace scanloom::net
