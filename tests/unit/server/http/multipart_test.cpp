#include "server/http/multipart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

using testing::HasSubstr;

constexpr std::string_view kType = "multipart/form-data; boundary=xyz";

std::string part(std::string_view name, std::string_view content) {
    return "--xyz\r\nContent-Disposition: form-data; name=\"" + std::string(name) +
           "\"; filename=\"a;b.pgm\"\r\nContent-Type: text/plain\r\n\r\n" + std::string(content) + "\r\n";
}

TEST(Multipart, FieldsEqualTheSentBytes) {
    const std::string bytes("a\r\n--xy\0\r\n-- \r\n", 16);
    const std::string body = part("image", bytes) + part("yaml", "") + "--xyz--\r\nepilogue";
    const auto fields = parse_form(kType, body);
    ASSERT_TRUE(fields) << fields.error().message;
    ASSERT_EQ(fields->size(), 2U);
    EXPECT_EQ(fields->at(0).name, "image");
    EXPECT_EQ(fields->at(0).content, bytes);
    EXPECT_EQ(fields->at(1).name, "yaml");
    EXPECT_EQ(fields->at(1).content, "");
}

TEST(Multipart, QuotedBoundaryIsAccepted) {
    EXPECT_EQ(parse_form("multipart/form-data; charset=utf-8; Boundary=\"xyz\"", part("a", "1") + "--xyz--")->size(),
              1U);
    EXPECT_TRUE(is_form("Multipart/Form-Data; boundary=x"));
    EXPECT_FALSE(is_form("multipart/form-datax"));
    EXPECT_FALSE(is_form("application/json"));
    EXPECT_FALSE(is_form(""));
}

TEST(Multipart, TruncatedFormsAreMalformed) {
    const std::string body = part("a", "1") + part("b", "2") + "--xyz--";
    for (std::size_t size = 0; size < body.size(); ++size) {
        const auto cut = parse_form(kType, std::string_view(body).substr(0, size));
        ASSERT_FALSE(cut) << size;
        EXPECT_EQ(cut.error().code, Errc::kMalformed);
    }
}

TEST(Multipart, OtherBodiesAreRefusedWithTheReason) {
    const std::string body = part("a", "1") + "--xyz--";
    EXPECT_THAT(parse_form("multipart/form-data", body).error().message, HasSubstr("no boundary"));
    EXPECT_THAT(parse_form("multipart/form-data; boundary=", body).error().message, HasSubstr("no boundary"));
    EXPECT_THAT(parse_form("multipart/form-data; boundary=abc", body).error().message, HasSubstr("begin"));
    EXPECT_THAT(parse_form(kType, "--xyz\r\n\r\n1\r\n--xyz--").error().message, HasSubstr("no name"));
    EXPECT_THAT(parse_form(kType, "--xyzz\r\n\r\n1\r\n--xyz--").error().message, HasSubstr("end its line"));
    EXPECT_EQ(parse_form(kType, part("a", "1") + part("a", "2") + "--xyz--").error().code, Errc::kInvalidField);
    std::string many;
    for (std::size_t n = 0; n <= kFormFieldsMax; ++n) many += part("f" + std::to_string(n), "");
    EXPECT_THAT(parse_form(kType, many + "--xyz--").error().message, HasSubstr("too many"));
}

} // namespace
} // namespace scanloom::http
