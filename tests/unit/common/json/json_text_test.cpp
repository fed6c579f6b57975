#include "common/json/json_text.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace scanloom {
namespace {

TEST(JsonWriter, WritesShortDecimalNumbers) {
    EXPECT_EQ(json_text(boost::json::array{0.05, 1.0, -20.1, 1e-9, std::uint64_t{7}, -3}), "[0.05,1,-20.1,1e-09,7,-3]");
    EXPECT_EQ(json_text(boost::json::array{10.0, 0.0, 0.00005, 123456789.5, -1e6, 1e20, 1e21}),
              "[10,0,0.00005,123456789.5,-1000000,100000000000000000000,1e+21]");
}

TEST(JsonWriter, WritesNonFiniteNumbersAsNull) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(json_text(boost::json::array{kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}),
              "[null,null,null]");
}

TEST(JsonWriter, ParsingReturnsTheWrittenValue) {
    const boost::json::value value = {{"a \"quoted\"\n\x01", {1, -2, 0.1, 1e300, 5e-324, true, nullptr, "\xC3\xA9"}},
                                      {"empty", boost::json::array{}},
                                      {"nested", {{"x", {{"y", boost::json::object{}}}}}}};
    EXPECT_EQ(boost::json::parse(json_text(value)), value);
}

} // namespace
} // namespace scanloom
