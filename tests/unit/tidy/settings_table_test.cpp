#include "core/mapping/map_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace scanloom::tidy {
namespace {

using testing::HasSubstr;

std::string default_of(const mapping::ConfigField& field) {
    return std::visit(
        []<class Value>(const Value& value) {
            if constexpr (std::is_same_v<Value, double>)
                return fmt::format("{:.6g}", value);
            else
                return fmt::format("{}", value);
        },
        mapping::value_of(field, mapping::MapConfig{}));
}

std::string values_of(const mapping::ConfigField& field) {
    const auto choices = mapping::choices_of(field);
    if (!choices.empty()) return fmt::format("`{}`", fmt::join(choices, "`, `"));
    if (std::holds_alternative<mapping::ConfigField::Member<bool>>(field.member)) return "`true`, `false`";
    const auto& bounds = field.bounds;
    return fmt::format("{}{:.6g}, {:.6g}{}{}{}", bounds.low_is_excluded ? '(' : '[', bounds.low, bounds.high,
                       bounds.high_is_excluded ? ')' : ']', *field.unit == '\0' ? "" : " ", field.unit);
}

std::string settings_table() {
    std::string table = "| setting | default | values | meaning |\n|---|---|---|---|\n";
    for (const auto& field : mapping::config_fields()) {
        table += fmt::format("| `{}` | {} | {} | {} |\n", field.name, default_of(field), values_of(field), field.help);
    }
    return table;
}

TEST(SettingsTable, InTheDocumentationIsThatOfTheDescriptors) {
    std::ifstream file(SCANLOOM_SOURCE_DIR "/docs/settings.md");
    const std::string page(std::istreambuf_iterator<char>(file), {});
    EXPECT_THAT(page, HasSubstr(settings_table())) << "replace the table in docs/settings.md by the expected one";
}

} // namespace
} // namespace scanloom::tidy
