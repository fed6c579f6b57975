#include "server/tiles/layer_style.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

namespace scanloom::tiles {
namespace {

TEST(OccupancyPercent, IsTheRoundedProbabilityOfEveryFixedPointValue) {
    for (int fixed = -32767; fixed <= 32767; ++fixed) {
        const double probability = 1.0 - 1.0 / (1.0 + std::exp(fixed / 2048.0));
        const int percent = percent_table()[static_cast<std::uint16_t>(fixed)];
        ASSERT_NEAR(percent, 100.0 * probability, 0.5 + 1e-9) << fixed;
    }
    EXPECT_EQ(percent_table()[static_cast<std::uint16_t>(mapping::kUnknownLogOdds)], kUnknownPercent);
    EXPECT_EQ(percent_table()[0], 50);
}

TEST(OccupancyPercent, SalienceOrdersHighestAboveHalfThenLowest) {
    int before = kUnknownSalience;
    const auto expect_next = [&](int percent) {
        const auto salience = salience_of(static_cast<Percent>(percent));
        EXPECT_EQ(salience, before + 1) << percent;
        EXPECT_EQ(style_of(mapping::Layer::kOccupancy).code[salience], percent);
        before = salience;
    };
    for (int percent = 50; percent >= 0; --percent) expect_next(percent);
    for (int percent = 51; percent <= 100; ++percent) expect_next(percent);
    EXPECT_EQ(salience_of(kUnknownPercent), kUnknownSalience);
    EXPECT_EQ(style_of(mapping::Layer::kOccupancy).code[kUnknownSalience], kUnknownPercent);
}

TEST(OccupancyPercent, GreysOfPercentagesAndUnknownAreDistinct) {
    std::set<int> greys{grey_of(kUnknownPercent)};
    for (int percent = 0; percent <= 100; ++percent) {
        const int grey = grey_of(static_cast<Percent>(percent));
        EXPECT_NEAR(grey, 255.0 * (1.0 - percent / 100.0), 0.5 + 1e-9);
        greys.insert(grey);
    }
    EXPECT_EQ(greys.size(), 102U);
    EXPECT_EQ(grey_of(0), 255);
    EXPECT_EQ(grey_of(100), 0);
    EXPECT_EQ(grey_of(kUnknownPercent), 128);
}

using mapping::Layer;

std::tuple<int, int, int> rgb(Layer layer, Code code) {
    const Colour colour = style_of(layer).palette[code];
    return {colour.red, colour.green, colour.blue};
}

TEST(LayerStyle, ValuesAreWhiteToBlackAndUnknownIsMidGrey) {
    for (const Layer layer : {Layer::kOccupancy, Layer::kSonar, Layer::kHimm}) {
        const Code last = layer == Layer::kHimm ? 15 : 100;
        EXPECT_EQ(rgb(layer, 0), (std::tuple{255, 255, 255}));
        EXPECT_EQ(rgb(layer, last), (std::tuple{0, 0, 0}));
        EXPECT_EQ(rgb(layer, 255), (std::tuple{128, 128, 128}));
        EXPECT_TRUE(style_of(layer).is_grey);
        for (Code code = 0; code < last; ++code) {
            const auto [red, green, blue] = rgb(layer, code);
            EXPECT_EQ(red, green);
            EXPECT_EQ(green, blue);
            EXPECT_GT(red, std::get<0>(rgb(layer, static_cast<Code>(code + 1))))
                << "more is darker, code " << int{code};
            EXPECT_NE(red, 128) << "that is of the unknown";
        }
    }
}

TEST(LayerStyle, ClassesHaveTheDocumentedColours) {
    const auto [grey_r, grey_g, grey_b] = rgb(Layer::kClassification, 0);
    EXPECT_TRUE(grey_r == grey_g && grey_g == grey_b && grey_r > 90 && grey_r < 220) << "unexplored: grey";
    const auto [pale_r, pale_g, pale_b] = rgb(Layer::kClassification, 1);
    EXPECT_TRUE(pale_r > 230 && pale_g > 230 && pale_b > 150 && pale_b < pale_g) << "free: pale yellow";
    const auto [brown_r, brown_g, brown_b] = rgb(Layer::kClassification, 2);
    EXPECT_TRUE(brown_r < 130 && brown_r > brown_g && brown_g > brown_b) << "occupied: dark brown";
    const auto [green_r, green_g, green_b] = rgb(Layer::kClassification, 3);
    EXPECT_TRUE(green_g > 100 && green_g > green_r + 40 && green_g > green_b + 40) << "frontier: green";
    const auto [red_r, red_g, red_b] = rgb(Layer::kClassification, 4);
    EXPECT_TRUE(red_r > 180 && red_r > red_g + 80 && red_r > red_b + 80) << "danger: red";
    EXPECT_FALSE(style_of(Layer::kClassification).is_grey);
}

TEST(LayerStyle, SalienceAndCodeTablesAreInverse) {
    for (const Layer layer : mapping::kLayers) {
        const auto& style = style_of(layer);
        std::set<Code> codes{style.unknown};
        const int last = layer == Layer::kHimm ? 15 : layer == Layer::kClassification ? 4 : 100;
        for (int code = 0; code <= last; ++code) codes.insert(static_cast<Code>(code));
        for (const Code code : codes) EXPECT_EQ(style.code[style.salience[code]], code) << mapping::name_of(layer);
        for (const Code code : codes) EXPECT_GE(style.salience[code], style.salience[style.unknown]);
    }
}

} // namespace
} // namespace scanloom::tiles
