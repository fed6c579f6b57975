#include "server/store/postgres_place.hpp"

#include <fmt/format.h>
#include <libpq-fe.h>

#include <algorithm>
#include <cstddef>
#include <memory>

namespace scanloom::store::postgres {

bool is_place(std::string_view text) { return text.starts_with("postgresql://") || text.starts_with("postgres://"); }

Result<Place> parse_place(const std::string& url) {
    char* what = nullptr;
    const std::unique_ptr<PQconninfoOption, decltype(&PQconninfoFree)> options(PQconninfoParse(url.c_str(), &what),
                                                                               &PQconninfoFree);
    if (!options) {
        Error error{Errc::kInvalidField, fmt::format("the address of the database: {}", one_line(what))};
        PQfreemem(what);
        return error;
    }
    Place place;
    std::string hosts;
    std::string ports;
    std::string database;
    std::string user;
    for (const auto* option = options.get(); option->keyword != nullptr; ++option) {
        if (option->val == nullptr || *option->val == '\0') continue;
        const std::string_view keyword = option->keyword;
        if (keyword == "host") {
            hosts = option->val;
        } else if (keyword == "port") {
            ports = option->val;
        } else {
            if (keyword == "dbname") database = option->val;
            if (keyword == "user") user = fmt::format("{}@", option->val);
            place.settings.emplace_back(keyword, option->val);
        }
    }
    if (database.empty()) {
        return Error{Errc::kInvalidField, "the address of the database names no database; write "
                                          "postgresql://USER@HOST/DATABASE"};
    }
    const auto words = [](std::string_view list) {
        std::vector<std::string> found;
        for (std::size_t begin = 0; begin <= list.size();) {
            const auto end = std::min(list.find(',', begin), list.size());
            found.emplace_back(list.substr(begin, end - begin));
            begin = end + 1;
        }
        return found;
    };
    const auto names = words(hosts);
    const auto numbers = words(ports);
    if (numbers.size() > 1 && numbers.size() != names.size()) {
        return Error{Errc::kInvalidField, fmt::format("the address of the database has {} hosts and {} ports",
                                                      names.size(), numbers.size())};
    }
    for (std::size_t n = 0; n < names.size(); ++n) {
        place.hosts.push_back({names[n], numbers.size() == 1 ? numbers.front() : numbers[n]});
    }
    place.text = fmt::format("postgresql://{}{}/{}", user, hosts, database);
    return place;
}

std::string one_line(std::string_view text) {
    std::string line;
    for (const char c : text) {
        const bool is_space = c == '\n' || c == '\t' || c == ' ';
        if (!is_space) line += c;
        if (is_space && !line.empty() && line.back() != ' ') line += ' ';
    }
    while (line.ends_with(' ') || line.ends_with('.')) line.pop_back();
    return line;
}

} // namespace scanloom::store::postgres
