#pragma once

#include "server/http/request.hpp"

#include <boost/json/object.hpp>

#include <random>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Requests generated from openapi.json: every operation, with valid, boundary and invalid values. The same seed
/// generates the same requests.
class RequestGenerator {
public:
    explicit RequestGenerator(unsigned seed) : random_(seed) {}

    [[nodiscard]] Request next();

private:
    [[nodiscard]] bool one_in(unsigned count) { return random_() % count == 0; }
    template <class Container>
    [[nodiscard]] const auto& any_of(const Container& values) {
        return values[random_() % values.size()];
    }

    [[nodiscard]] std::string target_for(std::string_view pattern, const boost::json::object& operation);
    [[nodiscard]] std::string path_value(std::string_view name, const boost::json::value& schema);
    [[nodiscard]] std::string text_of(const boost::json::value& schema);
    [[nodiscard]] boost::json::value value_of(const boost::json::value& schema, int depth = 0);
    [[nodiscard]] boost::json::value wrong_value();
    [[nodiscard]] boost::json::value number_of(const boost::json::object& schema, bool is_whole);
    [[nodiscard]] boost::json::value string_of(const boost::json::object& schema);
    [[nodiscard]] boost::json::value array_of(const boost::json::object& schema, int depth);
    [[nodiscard]] boost::json::object object_of(const boost::json::object& schema, int depth);
    [[nodiscard]] std::string json_body(const boost::json::value& schema);
    [[nodiscard]] std::string form_body();

    std::mt19937 random_;
};

} // namespace scanloom::http
