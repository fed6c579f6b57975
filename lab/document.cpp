#include "lab/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace scanloom::lab {

std::string range_text(std::span<const double> values, int digits) {
    if (values.empty()) return "nothing";
    const auto [low, high] = std::ranges::minmax(values);
    const auto low_text = fmt::format("{:.{}f}", low, digits);
    const auto high_text = fmt::format("{:.{}f}", high, digits);
    return low_text == high_text ? low_text : fmt::format("{} to {}", low_text, high_text);
}

namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.9rem; display: block; overflow-x: auto; }
th, td { padding: 0.15rem 0.6rem; text-align: right; border-bottom: 1px solid #8884; white-space: nowrap; }
th { border-bottom: 2px solid #888; }
th:first-child, td:first-child { text-align: left; }
pre { padding: 0.6rem 1rem; border: 1px solid #8884; overflow-x: auto; }
figure { margin: 1.5rem 0; }
img { max-width: 100%; height: auto; }
figcaption { font-size: 0.9rem; opacity: 0.8; }
)";

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
        case '&': out += "&amp;"; break;
        case '<': out += "&lt;"; break;
        case '>': out += "&gt;"; break;
        case '"': out += "&quot;"; break;
        default: out += c;
        }
    }
    return out;
}

std::string row_text(const std::vector<std::string>& cells, std::string_view tag) {
    std::string text = "<tr>";
    for (const std::string& cell : cells) text += fmt::format("<{}>{}</{}>", tag, escaped(cell), tag);
    return text + "</tr>\n";
}

std::string html_of(const Heading& heading) {
    return fmt::format("<h{}>{}</h{}>\n", heading.level, escaped(heading.text), heading.level);
}

std::string html_of(const Paragraph& paragraph) { return fmt::format("<p>{}</p>\n", escaped(paragraph.text)); }

std::string html_of(const Items& items) {
    std::string text = "<ul>\n";
    for (const std::string& item : items.texts) text += fmt::format("<li>{}</li>\n", escaped(item));
    return text + "</ul>\n";
}

std::string html_of(const Code& code) { return fmt::format("<pre>{}</pre>\n", escaped(code.text)); }

std::string html_of(const Link& link) {
    return fmt::format("<p><a href=\"{}.html\">{}</a></p>\n", escaped(link.file), escaped(link.text));
}

std::string html_of(const Table& table) {
    std::string text = "<table>\n<thead>\n" + row_text(table.head, "th") + "</thead>\n<tbody>\n";
    for (const auto& row : table.rows) text += row_text(row, "td");
    return text + "</tbody>\n</table>\n";
}

std::string html_of(const Picture& picture) {
    const std::string caption = escaped(picture.caption);
    return fmt::format("<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\" loading=\"lazy\"></a>"
                       "<figcaption>{1}</figcaption></figure>\n",
                       escaped(picture.file), caption);
}

} // namespace

std::string to_html(const Document& document, std::string_view title) {
    std::string text =
        fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n<style>{}</style>\n"
                    "</head>\n<body>\n",
                    escaped(title), kStyle);
    for (const Block& block : document) {
        text += std::visit([](const auto& content) { return html_of(content); }, block);
    }
    return text + "</body>\n</html>\n";
}

namespace {

std::string row_text(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

std::string markdown_of(const Heading& heading) {
    return fmt::format("{} {}\n", std::string(static_cast<std::size_t>(heading.level), '#'), heading.text);
}

std::string markdown_of(const Paragraph& paragraph) { return paragraph.text + "\n"; }

std::string markdown_of(const Items& items) {
    std::string text;
    for (const std::string& item : items.texts) text += fmt::format("- {}\n", item);
    return text;
}

std::string markdown_of(const Code& code) { return fmt::format("```sh\n{}\n```\n", code.text); }

std::string markdown_of(const Link& link) { return fmt::format("[{}]({}.md)\n", link.text, link.file); }

std::string markdown_of(const Table& table) {
    std::string text = row_text(table.head);
    text += row_text(std::vector<std::string>(table.head.size(), "---"));
    for (const auto& row : table.rows) text += row_text(row);
    return text;
}

std::string markdown_of(const Picture& picture) {
    return fmt::format("![{}]({})\n\n*{}*\n", picture.caption, picture.file, picture.caption);
}

} // namespace

std::string to_markdown(const Document& document) {
    std::string text;
    for (const Block& block : document) {
        if (!text.empty()) text += '\n';
        text += std::visit([](const auto& content) { return markdown_of(content); }, block);
    }
    return text;
}

} // namespace scanloom::lab
