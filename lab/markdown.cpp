#include "lab/markdown.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>

namespace scanloom::lab {
namespace {

constexpr std::string_view kBar = " | ";

/// Returns the parts of a text between separators; at least one.
std::vector<std::string_view> split(std::string_view text, std::string_view separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + separator.size());
    }
}

} // namespace

Table::Table(std::string_view head) : bars_(split(head, kBar).size()) {
    add_row(head);
    text_ += "\n|";
    for (std::size_t n = 0; n < bars_; ++n) text_ += " --- |";
}

void Table::add_row(std::string_view cells) {
    assert(split(cells, kBar).size() == bars_);
    text_ += fmt::format("{}| {} |", text_.empty() ? "" : "\n", cells);
}

std::string picture(std::string_view file, std::string_view caption) {
    return fmt::format("{}\n\n*{}*", picture_cell(file, caption), caption);
}

std::string picture_cell(std::string_view file, std::string_view caption) {
    return fmt::format("![{}]({}/{})", caption, kPicturesFolder, file);
}

std::string items(const std::vector<std::string>& texts) { return fmt::format("- {}", fmt::join(texts, "\n- ")); }

std::string range_text(std::span<const double> values, int digits) {
    if (values.empty()) return "nothing";
    const auto [low, high] = std::ranges::minmax(values);
    const auto low_text = fmt::format("{:.{}f}", low, digits);
    const auto high_text = fmt::format("{:.{}f}", high, digits);
    return low_text == high_text ? low_text : fmt::format("{} to {}", low_text, high_text);
}

namespace {

constexpr std::string_view kPageHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{}</title>
<style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.9rem; display: block; overflow-x: auto; }}
th, td {{ padding: 0.15rem 0.6rem; text-align: right; border-bottom: 1px solid #8884; white-space: nowrap; }}
th {{ border-bottom: 2px solid #888; }}
th:first-child, td:first-child {{ text-align: left; }}
pre {{ padding: 0.6rem 1rem; border: 1px solid #8884; overflow-x: auto; }}
figure {{ margin: 1.5rem 0; }}
img {{ max-width: 100%; height: auto; }}
figcaption {{ font-size: 0.9rem; opacity: 0.8; }}
</style>
</head>
<body>
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

/// Returns text and target of a link or picture: "[text](target)".
std::pair<std::string_view, std::string_view> parts_of_link(std::string_view link) {
    const auto begin = link.find('[') + 1;
    const auto middle = link.rfind("](");
    return {link.substr(begin, middle - begin), link.substr(middle + 2, link.size() - middle - 3)};
}

/// Returns a picture with a link to its file: "![caption](file)".
std::string html_picture(std::string_view picture) {
    const auto [caption, file] = parts_of_link(picture);
    return fmt::format("<a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\" loading=\"lazy\"></a>", file, caption);
}

/// Returns a row of a table: "| a | b |".
std::string html_row(std::string_view line, std::string_view tag) {
    std::string row = "<tr>";
    for (const auto cell : split(line.substr(2, line.size() - 4), kBar)) {
        row += fmt::format("<{0}>{1}</{0}>", tag, cell.starts_with("![") ? html_picture(cell) : std::string(cell));
    }
    return row + "</tr>\n";
}

/// Converts a block.
/// @param text  escaped
std::string html_of(std::string_view text) {
    if (text.empty()) return "";
    const auto lines = split(text, "\n");
    switch (text.front()) {
    case '#': {
        const auto level = text.find(' ');
        return fmt::format("<h{0}>{1}</h{0}>\n", level, text.substr(level + 1));
    }
    case '`': return fmt::format("<pre>{}</pre>\n", fmt::join(lines.begin() + 1, lines.end() - 1, "\n"));
    case '*': return ""; // the caption of a picture, which the picture has already
    case '-': {
        std::string list = "<ul>\n";
        for (const auto line : lines) list += fmt::format("<li>{}</li>\n", line.substr(2));
        return list + "</ul>\n";
    }
    case '|': {
        std::string table = "<table>\n<thead>\n" + html_row(lines[0], "th") + "</thead>\n<tbody>\n";
        for (std::size_t n = 2; n < lines.size(); ++n) table += html_row(lines[n], "td");
        return table + "</tbody>\n</table>\n";
    }
    case '!':
        return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", html_picture(text),
                           parts_of_link(text).first);
    case '[': {
        const auto [name, file] = parts_of_link(text);
        return fmt::format("<p><a href=\"{}.html\">{}</a></p>\n", file.substr(0, file.rfind(".md")), name);
    }
    default: return fmt::format("<p>{}</p>\n", text);
    }
}

} // namespace

std::string to_html(std::string_view markdown) {
    const std::string text = escaped(markdown.substr(0, markdown.find_last_not_of('\n') + 1));
    const auto blocks = split(text, "\n\n");
    std::string page = fmt::format(kPageHead, blocks.front().substr(2));
    for (const auto block : blocks) page += html_of(block);
    return page + "</body>\n</html>\n";
}

} // namespace scanloom::lab
