#pragma once

#include <string>

namespace scanloom::http {

/// A request as it arrived: nothing in it has been checked but that it is HTTP.
struct Request {
    std::string method = "GET";
    std::string target = "/";
    std::string content_type;  ///< empty when absent
    std::string if_none_match; ///< all such fields, joined with commas; empty when absent
    std::string body;
};

} // namespace scanloom::http
