#include "common/json/json_text.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace scanloom::http {
namespace {

using testing::HasSubstr;
using testing::Optional;

TEST(JsonContentType, AcceptsOnlyJson) {
    for (const auto* type :
         {"application/json", "Application/JSON", "application/json; charset=utf-8", "application/json ;x"}) {
        EXPECT_TRUE(is_json(type)) << type;
    }
    for (const auto* type :
         {"", "text/plain", "application/json5", "application/x-www-form-urlencoded", ";application/json"}) {
        EXPECT_FALSE(is_json(type)) << type;
    }
}

TEST(JsonObject, OtherValuesAreRefused) {
    for (const auto* body : {"", "{", "[]", "null", "1", "\"a\"", "{\"a\":}", "{\"a\":1,}", "{'a':1}", "{\"a\":1} x",
                             "{\"a\":NaN}", "{\"a\":01}", "// a\n{}", "{\"a\":\"\xFF\"}", "{\"a\":\"\n\"}"}) {
        const auto object = parse_json_object(body);
        ASSERT_FALSE(object) << body;
        EXPECT_EQ(object.error().code, Errc::kMalformed) << body;
    }
}

TEST(JsonObject, DepthIsBounded) {
    const std::string deep = "{\"a\":" + std::string(30'000, '[') + std::string(30'000, ']') + "}";
    EXPECT_FALSE(parse_json_object(deep));
    EXPECT_TRUE(parse_json_object("{\"a\":[[[[[[]]]]]]}"));
    EXPECT_FALSE(parse_json_object("{\"a\":[[[[[[[[[]]]]]]]]]}"));
}

TEST(JsonObject, UnknownMembersAreNamed) {
    constexpr std::array<std::string_view, 2> kKnown = {"name", "cell_size"};
    const auto object = parse_json_object(R"({"name":"a","cellsize":1})");
    ASSERT_TRUE(object);
    const auto checked = check_members(*object, kKnown);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::kInvalidField);
    EXPECT_THAT(checked.error().message, AllOf(HasSubstr("\"cellsize\""), HasSubstr("name, cell_size")));
}

TEST(JsonObject, DuplicateKeyIsNamed) {
    for (const auto* body : {R"({"a":1,"b":2,"a":1})", R"({"x":{"a":1,"a":2}})", R"({"x":[{"b":0},{"a":1,"a":2}]})",
                             R"({"a":1,"\u0061":2})"}) {
        const auto object = parse_json_object(body);
        ASSERT_FALSE(object) << body;
        EXPECT_EQ(object.error().code, Errc::kInvalidField);
        EXPECT_THAT(object.error().message, HasSubstr("\"a\" is given twice")) << body;
    }
    for (const auto* body : {R"({"a":{"a":[{"a":1},{"a":"a"}]},"b":{"a":1}})", R"({"a":1,"A":2})"}) {
        EXPECT_TRUE(parse_json_object(body)) << body;
    }
}

TEST(JsonText, MissingOrOtherTypesAreRefused) {
    const auto object = parse_json_object(R"({"name":"a","other":7,"none":null})").value();
    EXPECT_EQ(read_text(object, "name").value(), "a");
    for (const auto* name : {"other", "none", "missing"}) {
        const auto text = read_text(object, name);
        ASSERT_FALSE(text) << name;
        EXPECT_EQ(text.error().code, Errc::kInvalidField);
        EXPECT_THAT(text.error().message, HasSubstr(name));
    }
}

TEST(JsonNumber, IsAFiniteNumberOrAbsent) {
    const auto object = parse_json_object(R"({"i":3,"d":0.05,"n":-2,"u":18446744073709551615})").value();
    EXPECT_THAT(read_number(object, "i").value(), Optional(3.0));
    EXPECT_THAT(read_number(object, "d").value(), Optional(0.05));
    EXPECT_THAT(read_number(object, "n").value(), Optional(-2.0));
    EXPECT_THAT(read_number(object, "u").value(), Optional(18446744073709551615.0));
    EXPECT_EQ(read_number(object, "missing").value(), std::nullopt);
}

TEST(JsonNumber, OtherTypesAreNamed) {
    for (const auto* value : {"\"1\"", "true", "null", "[]", "{}"}) {
        const auto object = parse_json_object("{\"cell_size\":" + std::string(value) + "}").value();
        const auto number = read_number(object, "cell_size");
        ASSERT_FALSE(number) << value;
        EXPECT_EQ(number.error().code, Errc::kInvalidField);
        EXPECT_THAT(number.error().message, HasSubstr("cell_size"));
    }
}

TEST(JsonNumber, OverflowIsRefused) {
    for (const auto* value : {"1e999", "-1e999", "1e99999999999999999999"}) {
        const auto object = parse_json_object("{\"cell_size\":" + std::string(value) + "}");
        EXPECT_FALSE(object && read_number(*object, "cell_size")) << value;
    }
}

TEST(Number, IntegersAreDigitsInRange) {
    EXPECT_EQ(parse_integer<std::uint64_t>("42"), 42U);
    EXPECT_EQ(parse_integer<std::uint64_t>("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(parse_integer<std::int64_t>("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
    EXPECT_EQ(parse_integer<std::int64_t>("-9223372036854775809"), std::nullopt);
    for (const auto* text :
         {"18446744073709551616", "99999999999999999999999", "", " 1", "1 ", "+1", "0x1", "1.0", "1e3", "-", "-1"}) {
        EXPECT_EQ(parse_integer<std::uint64_t>(text), std::nullopt) << text;
    }
}

TEST(Number, MetresAreRounded) {
    EXPECT_EQ(json_text(boost::json::array{rounded_metres(-399 * 0.05), rounded_metres(3 * 0.1), rounded_metres(1e-7)}),
              "[-19.95,0.3,0]");
    EXPECT_EQ(rounded_metres(1e307), 1e307);
}

TEST(Number, RealsAreFinite) {
    EXPECT_EQ(parse_real("-1.5e1"), -15.0);
    for (const auto* text : {"", "nan", "inf", "-inf", "1e999", "1,5", " 1", "+1", "0x10", "1."}) {
        const bool is_odd = std::string_view(text) == "1.";
        EXPECT_EQ(parse_real(text).has_value(), is_odd) << text;
    }
}

} // namespace
} // namespace scanloom::http
