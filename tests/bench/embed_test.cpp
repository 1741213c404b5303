#include "umbra/bench/pages/embed.h"

#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

class EmbeddedPage : public testing::Test {
protected:
    [[nodiscard]] std::string embedded(const std::string& html) const {
        return embedded_page(folder_.write("out/page.html", html));
    }
    TemporaryFolder folder_;
};

TEST_F(EmbeddedPage, HoldsPicturesStylesAndScripts) {
    static_cast<void>(folder_.write("out/page.files/a b&c.png", "png"));
    static_cast<void>(folder_.write("report.css", "body{background:url(dot.svg)}a{fill:url(#x)}"));
    static_cast<void>(folder_.write("dot.svg", "<svg/>"));
    static_cast<void>(folder_.write("slider.js", "1<2"));
    static_cast<void>(folder_.write("out/values.js", "v"));
    // RFC 4648: "png" is cG5n, "1<2" MTwy, "v" dg==, "<svg/>" PHN2Zy8+.
    EXPECT_EQ(
        embedded("<!DOCTYPE html>\n<img src=\"page.files&#x2F;a%20b%26c.png\" alt='x \"y\"' loading=\"lazy\"><hr/>"),
        "<!DOCTYPE html>\n<img src=\"data:image/png;base64,cG5n\" alt=\"x &quot;y&quot;\" loading=\"lazy\"><hr/>");
    EXPECT_EQ(embedded("<script src=\"../slider.js\" defer></script>"),
              "<script src=\"data:text/javascript;base64,MTwy\" defer></script>");
    EXPECT_EQ(embedded("<section hidden data-src=\"values.js\"></section>"),
              "<section hidden data-src=\"data:text/javascript;base64,dg==\"></section>");
    const std::string css = embedded("<link rel=stylesheet href=../report.css>");
    // body{background:url(data:image/svg+xml;base64,PHN2Zy8+)}a{fill:url(#x)}
    EXPECT_EQ(css,
              "<link rel=\"stylesheet\" href=\"data:text/css;base64,"
              "Ym9keXtiYWNrZ3JvdW5kOnVybChkYXRhOmltYWdlL3N2Zyt4bWw7YmFzZTY0LFBITjJaeTgrKX1he2ZpbGw6dXJsKCN4KX0=\">");
    EXPECT_EQ(embedded("<style>i{background:url(\"../dot.svg\")}</style><p style=\"background:url('../dot.svg')\">"),
              "<style>i{background:url(data:image/svg+xml;base64,PHN2Zy8+)}</style>"
              "<p style=\"background:url(data:image/svg+xml;base64,PHN2Zy8+)\">");
}

TEST_F(EmbeddedPage, DropsLinksToFilesAndKeepsOthers) {
    EXPECT_EQ(embedded("<a class=\"x\" href=\"other.html#part\">other</a>"), "<a class=\"x\">other</a>");
    EXPECT_EQ(embedded("<a href=\"page.html#part\">here</a>"), "<a href=\"#part\">here</a>");
    EXPECT_EQ(embedded("<section data-src=\"none.js\">"), "<section>");
    for (const char* same :
         {"<a href=\"#part\">x</a>", "<a href=\"https://example.org/a.html?b&amp;c\">x</a>",
          "<link rel=\"icon\" href=\"data:image/svg+xml,%3Csvg%3E\">", "<img src=\"data:image/png;base64,AA==\">",
          "<a href=\"mailto:a@b.org\">x</a>", "<script>if (a<b) x = '<img src=\"no.png\">';</script>",
          "<!-- <img src=\"no.png\"> -->", "1 < 2 <b>and</b> <input disabled value=\"a=b\">"})
        EXPECT_EQ(embedded(same), same);
}

TEST_F(EmbeddedPage, NamesWhatIsMissing) {
    for (const char* html : {"<img src=\"none.png\">", "<style>a{b:url(none.png)}</style>"}) {
        try {
            static_cast<void>(embedded(html));
            FAIL() << html;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("none.png: cannot be opened, expected a file that "),
                      std::string::npos)
                << error.what();
        }
    }
    EXPECT_THROW(static_cast<void>(embedded_page(folder_.path() / "none.html")), InputError);
    for (const char* cut : {"<", "<img", "<img src", "<img src=", "<img src=\"", "<style>", "<!--", "<script>"})
        static_cast<void>(embedded(cut));
    // Files in blocks are one: 3 MiB and a byte.
    static_cast<void>(folder_.write("out/large.png", std::string((3u << 20) + 1, 'a')));
    const std::string large = embedded("<img src=\"large.png\">");
    EXPECT_EQ(large.size(), std::string("<img src=\"data:image/png;base64,\">").size() + (4u << 20) + 4);
    EXPECT_TRUE(large.ends_with("YWFhYQ==\">"));
}

}  // namespace
}  // namespace umbra
