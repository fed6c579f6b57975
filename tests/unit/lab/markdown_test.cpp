#include "lab/markdown.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

TEST(Markdown, TablesAndPicturesAreBlocks) {
    Table table("cell | IoU | published");
    table.add("{} m | {}", 0.1, "0.90 | ");
    table.add("{} m | {:.1f} | {}", 0.5, 0.8, "0.7");
    EXPECT_EQ(table.text(), "| cell | IoU | published |\n"
                            "| --- | --- | --- |\n"
                            "| 0.1 m | 0.90 |  |\n"
                            "| 0.5 m | 0.8 | 0.7 |");
    EXPECT_EQ(picture("a.png", "The \"room\""), "![The \"room\"](pictures/a.png)\n\n*The \"room\"*");
    EXPECT_EQ(items({"one", "two"}), "- one\n- two");
}

const char* const kReport = "# Maps & walls\n"
                            "\n"
                            "A < B.\n"
                            "\n"
                            "- one\n"
                            "- two\n"
                            "\n"
                            "```sh\nmake > all\n```\n"
                            "\n"
                            "[Times](times.md)\n"
                            "\n"
                            "| cell | IoU |  |\n"
                            "| --- | --- | --- |\n"
                            "| 0.1 m | 0.9 |  |\n"
                            "| 0.5 m |  | 0.8 |\n"
                            "\n"
                            "![The \"room\" (1)](pictures/a.png)\n"
                            "\n"
                            "*The \"room\" (1)*\n";

TEST(Markdown, HtmlHasTheSameBlocks) {
    const auto html = to_html(kReport);
    EXPECT_THAT(html, testing::StartsWith("<!DOCTYPE html>"));
    EXPECT_THAT(html, HasSubstr("<title>Maps &amp; walls</title>"));
    EXPECT_THAT(html, HasSubstr("<h1>Maps &amp; walls</h1>\n"
                                "<p>A &lt; B.</p>\n"
                                "<ul>\n<li>one</li>\n<li>two</li>\n</ul>\n"
                                "<pre>make &gt; all</pre>\n"
                                "<p><a href=\"times.html\">Times</a></p>\n"
                                "<table>\n<thead>\n<tr><th>cell</th><th>IoU</th><th></th></tr>\n</thead>\n<tbody>\n"
                                "<tr><td>0.1 m</td><td>0.9</td><td></td></tr>\n"
                                "<tr><td>0.5 m</td><td></td><td>0.8</td></tr>\n</tbody>\n</table>\n"
                                "<figure><a href=\"pictures/a.png\"><img src=\"pictures/a.png\" "
                                "alt=\"The &quot;room&quot; (1)\""));
    EXPECT_THAT(html,
                testing::EndsWith("<figcaption>The &quot;room&quot; (1)</figcaption></figure>\n</body>\n</html>\n"));
    EXPECT_THAT(html, Not(HasSubstr("<script"))) << "the page must not need other files";
    EXPECT_THAT(html, Not(HasSubstr("http")));
}

TEST(Markdown, TablesMayContainPictures) {
    Table table("first | second");
    table.add("{} | {}", picture_cell("a.png", "one < two"), "text");
    EXPECT_THAT(table.text(), HasSubstr("| ![one < two](pictures/a.png) | text |"));
    EXPECT_THAT(to_html("# Title\n\n" + table.text()),
                HasSubstr("<tr><td><a href=\"pictures/a.png\"><img src=\"pictures/a.png\" alt=\"one &lt; two\" "
                          "loading=\"lazy\"></a></td><td>text</td></tr>"));
}

} // namespace
} // namespace scanloom::lab
