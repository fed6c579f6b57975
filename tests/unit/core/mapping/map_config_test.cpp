#include "core/mapping/map_config.hpp"

#include "tests/support/angles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace scanloom::mapping {
namespace {

void expect_refused(const SessionOptions& options, const std::string& field) {
    const auto config = resolve(options);
    ASSERT_FALSE(config) << field;
    EXPECT_EQ(config.error().code, Errc::kInvalidField);
    EXPECT_THAT(config.error().message, testing::StartsWith(field + " is "));
}

TEST(MapConfig, AbsentOptionsTakeTheDefaults) {
    const auto config = resolve({});
    ASSERT_TRUE(config);
    EXPECT_EQ(*config, MapConfig{});
}

/// Values near a field's limits: refused values, and accepted values just inside the limits.
struct FieldValues {
    const char* field;
    std::vector<double> refused;
    std::vector<double> accepted;
};

const double kNan = NAN;

const std::vector<FieldValues> kFieldValues = {
    {"cell_size", {0.0, -0.05, 0.00999, 1.00001, 1e300, HUGE_VAL, kNan}, {0.01, 0.05, 0.1, 0.5, 1.0}},
    {"hit_radius", {-0.001, 1.001, HUGE_VAL, kNan}, {0.0}},
    {"p_occupied", {0.50001, 0.5, 1.0, 0.2, -1.0, 2.0, kNan}, {0.501, 0.999}},
    {"p_free", {0.0, 0.49999, 0.5, 0.7, -1.0, kNan}, {0.499, 0.001}},
    {"p_prior", {0.0, 1.0, 0.95, 0.05, 0.1, 0.9, kNan}, {0.11, 0.89}},
    {"p_min", {0.0, 0.2, 0.5, -0.1, 1e-7, kNan}, {1e-6, 0.1}},
    {"p_max", {0.8, 1.0, 1.5, 1.0 - 1e-7, kNan}, {0.9, 0.999999}},
    {"obstacle_thickness", {0.0, -1.0, 10.01, HUGE_VAL, kNan}, {0.001, 10.0}},
    {"beam_aperture", {0.0, -1.0, 3.142, HUGE_VAL, kNan}, {0.0001, kPi}},
    {"himm_increment", {0, -1, 16}, {1, 15}},
    {"himm_decrement", {0, -1, 16}, {1, 15}},
    {"himm_obstacle_thickness", {0.0, -1.0, 10.01, kNan}, {0.001, 10.0}},
    {"himm_beam_aperture", {0.0, -1.0, 3.142, kNan}, {0.0001, kPi}},
    {"sonar_obstacle_thickness", {0.0, -1.0, 10.01, kNan}, {0.001, 10.0}},
    {"sonar_beam_aperture", {0.0, -1.0, 3.142, kNan}, {0.0001, kPi}},
    {"sonar_p_occupied_max", {0.5, 1.0, 0.3, kNan}, {0.51, 0.999}},
    {"sonar_p_min", {0.0, 0.5, -0.1, kNan}, {0.000001, 0.49}},
    {"sonar_p_max", {0.5, 1.0, 1.1, kNan}, {0.51, 0.999999}},
    {"class_p_occupied", {0.0, 1.0, -0.5, 1.5, kNan}, {0.36, 0.99}},
    {"class_p_free", {0.0, 0.65, 0.7, 1.0, -0.1, kNan}, {0.01, 0.64}},
    {"class_himm_occupied", {0, -1, 16}, {5, 15}},
    {"class_himm_free", {-1, 8, 15}, {0, 7}},
    {"danger_cells", {0, -1, 65}, {1, 64}},
    {"danger_radius", {-0.01, 3.21, HUGE_VAL, kNan}, {0.0, 0.01, 3.2}},
    {"max_jump", {-0.01, 100'001.0, HUGE_VAL, kNan}, {0.0, 0.01, 100'000.0}},
};

SessionOptions with(const char* name, double value) {
    const ConfigField& field = *find_config_field(name);
    const bool is_whole = std::holds_alternative<std::int32_t>(value_of(field, {}));
    SessionOptions options;
    EXPECT_TRUE(set_option(options, field, is_whole ? ConfigValue(static_cast<std::int32_t>(value)) : value)) << name;
    return options;
}

TEST(MapConfig, RefusesValuesOutOfRangeByFieldName) {
    for (const auto& values : kFieldValues) {
        for (const double value : values.refused) expect_refused(with(values.field, value), values.field);
        for (const double value : values.accepted) {
            EXPECT_TRUE(resolve(with(values.field, value))) << values.field << " " << value;
        }
    }
}

TEST(MapConfig, EveryNumberHasLimits) {
    std::set<std::string> checked;
    for (const auto& values : kFieldValues) checked.insert(values.field);
    for (const auto& field : config_fields()) {
        const auto value = value_of(field, {});
        const bool is_number = std::holds_alternative<double>(value) || std::holds_alternative<std::int32_t>(value);
        EXPECT_EQ(checked.contains(field.name), is_number) << field.name;
    }
}

TEST(MapConfig, FieldListContainsEveryOption) {
    // Each option takes 2, 3 or 24 bytes more than its optional's flag. An option that is missing in the list would
    // stay absent.
    SessionOptions all = options_of({});
    std::size_t set = 0;
    for (const auto& field : config_fields()) {
        std::visit([&](const auto& member) { set += (all.*member.option).has_value(); }, field.member);
    }
    EXPECT_EQ(set, config_fields().size());
    EXPECT_EQ(set, 29U) << "SessionOptions has 29 members";
}

TEST(MapConfig, RefusesInvalidCombinationsByFieldName) {
    const auto none = RayModel::kInverseSensorModel;
    expect_refused({.accumulate = true}, "accumulate");
    expect_refused({.ray_model = none, .accumulate = true}, "accumulate");
    EXPECT_TRUE(resolve({.ray_model = none, .accumulate = false}));
    EXPECT_TRUE(resolve({.ray_model = RayModel::kBresenham, .accumulate = true}));
    EXPECT_TRUE(resolve({.ray_model = RayModel::kTraversal, .accumulate = true}));
    expect_refused({.hit_radius = 0.2}, "hit_radius");
    expect_refused({.ray_model = RayModel::kTraversal, .hit_radius = 0.2}, "hit_radius");
    EXPECT_TRUE(resolve({.ray_model = RayModel::kBresenham, .hit_radius = 1.0}));
    expect_refused({.class_p_occupied = 0.4, .class_p_free = 0.4}, "class_p_free");
    expect_refused({.class_p_occupied = 0.3, .class_p_free = 0.4}, "class_p_free");
    expect_refused({.class_p_occupied = 0.3}, "class_p_free");
    expect_refused({.class_himm_occupied = 4}, "class_himm_free");
    expect_refused({.class_himm_occupied = 10, .class_himm_free = 10}, "class_himm_free");
    EXPECT_TRUE(resolve({.class_himm_occupied = 10, .class_himm_free = 9}));
    expect_refused({.cell_size = 0.01, .danger_radius = 0.65}, "danger_radius");
    EXPECT_TRUE(resolve({.cell_size = 1.0, .danger_radius = 64.0}));
    expect_refused({.p_occupied = 0.9995}, "p_max");
    expect_refused({.p_free = 0.0005}, "p_min");
}

TEST(MapConfig, DangerReachIsAtLeastTheRadius) {
    const auto reach = [](double cell_size, double radius) {
        return danger_reach(resolve({.cell_size = cell_size, .danger_radius = radius}).value());
    };
    EXPECT_EQ(danger_reach({}), 3);
    EXPECT_EQ(danger_reach(resolve({.danger_cells = 7}).value()), 7);
    EXPECT_EQ(reach(0.05, 0.15), 3) << "independent of rounding";
    EXPECT_EQ(reach(0.1, 0.3), 3);
    EXPECT_EQ(reach(0.05, 0.16), 4);
    EXPECT_EQ(reach(0.5, 0.15), 1) << "at least one cell";
    EXPECT_EQ(reach(0.01, 0.64), 64);
}

class AnyField : public testing::TestWithParam<const char*> {};

std::vector<const char*> names_of_fields() {
    std::vector<const char*> names;
    for (const auto& field : config_fields()) names.push_back(field.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(MapConfig, AnyField, testing::ValuesIn(names_of_fields()),
                         [](const auto& tried) { return std::string(tried.param); });

TEST_P(AnyField, IsFoundOnlyByItsExactName) {
    const std::string name = GetParam();
    ASSERT_NE(find_config_field(name), nullptr);
    EXPECT_EQ(find_config_field(name)->name, name);
    for (const std::string& other : {name + " ", name + "s", name.substr(1), std::string("P_") + name}) {
        EXPECT_EQ(find_config_field(other), nullptr) << other;
    }
}

TEST_P(AnyField, RefusesValuesOfAnotherTypeByName) {
    const ConfigField& field = *find_config_field(GetParam());
    const ConfigValue kept = value_of(field, {});
    for (const ConfigValue& value : {ConfigValue(true), ConfigValue(3), ConfigValue(0.5), ConfigValue("stone")}) {
        SessionOptions options;
        const auto set = set_option(options, field, value);
        const bool fits = value.index() == kept.index() && !std::holds_alternative<std::string_view>(value);
        const bool is_whole_for_number =
            std::holds_alternative<double>(kept) && std::holds_alternative<std::int32_t>(value);
        EXPECT_EQ(static_cast<bool>(set), fits || is_whole_for_number) << value.index();
        if (set) continue;
        EXPECT_EQ(set.error().code, Errc::kInvalidField);
        EXPECT_THAT(set.error().message, testing::StartsWith(field.name + std::string(" must be ")));
        EXPECT_EQ(options, SessionOptions{}) << "a refused value leaves the options unchanged";
    }
}

TEST_P(AnyField, IsParsedFromItsOwnText) {
    const ConfigField& field = *find_config_field(GetParam());
    const auto text = std::visit(
        [](const auto& value) {
            std::ostringstream out;
            out << std::boolalpha << std::setprecision(17) << value;
            return out.str();
        },
        value_of(field, {}));
    SessionOptions options;
    const auto set = set_option(options, field, std::string_view(text));
    ASSERT_TRUE(set) << text;
    EXPECT_EQ(value_of(field, resolve(options).value()), value_of(field, {})) << text;

    for (const char* wrong : {"", " ", "x", "1x", "0.1.2", "True", "1 2", "0x10", "+-1", "99999999999999999999"}) {
        const std::string_view given = wrong;
        SessionOptions untouched;
        const auto refused = set_option(untouched, field, given);
        if (refused) { // a number of that size is valid here for number fields; resolve() checks the limits
            EXPECT_EQ(given, "99999999999999999999") << GetParam();
            continue;
        }
        EXPECT_THAT(refused.error().message, testing::StartsWith(field.name + std::string(" must be "))) << wrong;
        EXPECT_EQ(untouched, SessionOptions{});
    }
}

TEST(MapConfig, RefusesTextThatIsNotAFiniteNumber) {
    for (const char* text : {"nan", "inf", "-inf", "NaN", "infinity"}) {
        SessionOptions options;
        if (!set_option(options, *find_config_field("cell_size"), std::string_view(text))) continue;
        expect_refused(options, "cell_size");
    }
}

TEST(MapConfig, ParsesChoicesByName) {
    for (const auto& [name, text, is_possible] : {std::tuple{"ray_model", "inverse_sensor_model", true},
                                                  {"ray_model", "bresenham", true},
                                                  {"ray_model", "traversal", true},
                                                  {"ray_model", "Bresenham", false},
                                                  {"ray_model", "", false},
                                                  {"ray_model", "occupancy", false},
                                                  {"class_source", "occupancy", true},
                                                  {"class_source", "himm", true},
                                                  {"class_source", "sonar", false}}) {
        SessionOptions options;
        const auto set = set_option(options, *find_config_field(name), ConfigValue(std::string_view(text)));
        ASSERT_EQ(static_cast<bool>(set), is_possible) << name << " " << text;
        if (set) {
            EXPECT_EQ(value_of(*find_config_field(name), resolve(options).value()),
                      ConfigValue(std::string_view(text)));
        } else {
            EXPECT_THAT(set.error().message, testing::HasSubstr("must be one of "));
        }
    }
}

TEST(MapConfig, OptionsOfAConfigResolveToTheSameConfig) {
    const auto config = resolve({.cell_size = 0.1, .p_free = 0.3, .obstacle_thickness = 0.4});
    ASSERT_TRUE(config);
    EXPECT_EQ(*resolve(options_of(*config)), *config);
}

TEST(MapConfig, DifferentRequestIsAConflictThatNamesTheField) {
    const MapConfig config;
    EXPECT_TRUE(check_agreement(config, {}));
    EXPECT_TRUE(check_agreement(config, {.cell_size = 0.05}));
    const auto conflict = check_agreement(config, {.cell_size = 0.1});
    ASSERT_FALSE(conflict);
    EXPECT_EQ(conflict.error().code, Errc::kConflict);
    EXPECT_THAT(conflict.error().message, testing::HasSubstr("cell_size 0.05, cell_size 0.1"));
}

TEST_P(AnyField, IsComparedByCheckAgreement) {
    const ConfigField& field = *find_config_field(GetParam());
    SessionOptions other;
    SessionOptions same;
    std::visit(
        [&]<class Value>(const ConfigField::Member<Value>& member) {
            const MapConfig config;
            same.*member.option = config.*member.value;
            if constexpr (std::is_enum_v<Value>) {
                other.*member.option = static_cast<Value>(1);
            } else if constexpr (std::is_same_v<Value, bool>) {
                other.*member.option = !(config.*member.value);
            } else {
                other.*member.option = static_cast<Value>(config.*member.value + 1);
            }
        },
        field.member);
    EXPECT_TRUE(check_agreement({}, same));
    const auto conflict = check_agreement({}, other);
    ASSERT_FALSE(conflict);
    EXPECT_EQ(conflict.error().code, Errc::kConflict);
    EXPECT_THAT(conflict.error().message, testing::HasSubstr(field.name));
}

} // namespace
} // namespace scanloom::mapping
