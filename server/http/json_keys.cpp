#include "server/http/json_keys.hpp"

#include <boost/json/basic_parser_impl.hpp>

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// The parser's handler: called for each part of a JSON text; returning false ends the parsing.
struct KeyWatch {
    static constexpr std::size_t max_object_size = SIZE_MAX;
    static constexpr std::size_t max_array_size = SIZE_MAX;
    static constexpr std::size_t max_key_size = SIZE_MAX;
    static constexpr std::size_t max_string_size = SIZE_MAX;

    using Failed = boost::json::error_code;
    using Text = boost::json::string_view;

    bool on_object_begin(Failed&) {
        open_.emplace_back();
        return true;
    }
    bool on_object_end(std::size_t, Failed&) {
        open_.pop_back();
        return true;
    }
    bool on_key_part(Text text, std::size_t, Failed&) {
        key_.append(text.data(), text.size());
        return true;
    }
    bool on_key(Text text, std::size_t, Failed&) {
        key_.append(text.data(), text.size());
        if (open_.back().insert(key_).second) {
            key_.clear();
            return true;
        }
        duplicate = std::move(key_);
        return false;
    }

    bool on_document_begin(Failed&) { return true; }
    bool on_document_end(Failed&) { return true; }
    bool on_array_begin(Failed&) { return true; }
    bool on_array_end(std::size_t, Failed&) { return true; }
    bool on_string_part(Text, std::size_t, Failed&) { return true; }
    bool on_string(Text, std::size_t, Failed&) { return true; }
    bool on_number_part(Text, Failed&) { return true; }
    bool on_int64(std::int64_t, Text, Failed&) { return true; }
    bool on_uint64(std::uint64_t, Text, Failed&) { return true; }
    bool on_double(double, Text, Failed&) { return true; }
    bool on_bool(bool, Failed&) { return true; }
    bool on_null(Failed&) { return true; }
    bool on_comment_part(Text, Failed&) { return true; }
    bool on_comment(Text, Failed&) { return true; }

    std::optional<std::string> duplicate;

private:
    std::vector<std::set<std::string>> open_; // keys of the enclosing objects, outermost first
    std::string key_;
};

} // namespace

std::optional<std::string> duplicate_key(std::string_view json) {
    boost::json::basic_parser<KeyWatch> parser({});
    boost::json::error_code ignored; // the callers check that it is well-formed
    parser.write_some(false, json.data(), json.size(), ignored);
    return std::move(parser.handler().duplicate);
}

} // namespace scanloom::http
