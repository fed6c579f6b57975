#include "lab/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

const Document kDocument{Heading{2, "Maps & walls"},
                         Paragraph{"A < B."},
                         Items{{"one", "two"}},
                         Code{"make > all"},
                         Link{"Times", "times"},
                         Table{{"cell", "IoU"}, {{"0.1 m", "0.9"}, {"0.5 m", "0.8"}}},
                         Picture{"pictures/a.png", "The \"room\""}};

TEST(Document, IsWrittenAsMarkdown) {
    EXPECT_EQ(to_markdown(kDocument), "## Maps & walls\n"
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
                                      "| cell | IoU |\n"
                                      "| --- | --- |\n"
                                      "| 0.1 m | 0.9 |\n"
                                      "| 0.5 m | 0.8 |\n"
                                      "\n"
                                      "![The \"room\"](pictures/a.png)\n"
                                      "\n"
                                      "*The \"room\"*\n");
}

TEST(Document, HtmlIsEscaped) {
    const auto html = to_html(kDocument, "<title>");
    EXPECT_THAT(html, testing::StartsWith("<!DOCTYPE html>"));
    EXPECT_THAT(html, HasSubstr("<title>&lt;title&gt;</title>"));
    EXPECT_THAT(html, HasSubstr("<h2>Maps &amp; walls</h2>"));
    EXPECT_THAT(html, HasSubstr("<p>A &lt; B.</p>"));
    EXPECT_THAT(html, HasSubstr("<li>two</li>"));
    EXPECT_THAT(html, HasSubstr("<pre>make &gt; all</pre>"));
    EXPECT_THAT(html, HasSubstr("<a href=\"times.html\">Times</a>"));
    EXPECT_THAT(html, HasSubstr("<tr><th>cell</th><th>IoU</th></tr>"));
    EXPECT_THAT(html, HasSubstr("<tr><td>0.5 m</td><td>0.8</td></tr>"));
    EXPECT_THAT(html, HasSubstr("<img src=\"pictures/a.png\" alt=\"The &quot;room&quot;\""));
    EXPECT_THAT(html, Not(HasSubstr("<script"))) << "the page must not need other files";
    EXPECT_THAT(html, Not(HasSubstr("http")));
}

} // namespace
} // namespace scanloom::lab
