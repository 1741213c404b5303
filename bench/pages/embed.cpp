#include "umbra/bench/pages/embed.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string_view media_type(const fs::path& file) {
    constexpr std::array kTypes = {std::pair{".css", "text/css"},          std::pair{".js", "text/javascript"},
                                   std::pair{".png", "image/png"},         std::pair{".jpg", "image/jpeg"},
                                   std::pair{".jpeg", "image/jpeg"},       std::pair{".svg", "image/svg+xml"},
                                   std::pair{".webp", "image/webp"},       std::pair{".gif", "image/gif"},
                                   std::pair{".json", "application/json"}, std::pair{".woff2", "font/woff2"}};
    for (const auto& [ending, type] : kTypes)
        if (file.extension() == ending) return type;
    return "application/octet-stream";
}

/// "https:", "data:", "mailto:", or "//": not a file beside the page.
bool has_scheme(std::string_view address) {
    if (address.starts_with("//")) return true;
    const std::size_t colon = address.find(':');
    return colon != std::string_view::npos && address.substr(0, colon).find_first_of("/?#") == std::string_view::npos;
}

bool is_local_file(std::string_view address) {
    return !address.empty() && address.front() != '#' && !has_scheme(address);
}

/// The attribute's value as a browser reads it.
std::string without_entities(std::string_view value) {
    std::string text;
    for (std::size_t at = 0; at < value.size();) {
        const std::size_t end = value[at] == '&' ? value.find(';', at) : std::string_view::npos;
        if (end == std::string_view::npos) {
            text += value[at++];
            continue;
        }
        const std::string_view name = value.substr(at + 1, end - at - 1);
        int code                    = 0;
        for (const auto& [entity, c] : {std::pair{"amp", '&'}, std::pair{"lt", '<'}, std::pair{"gt", '>'},
                                        std::pair{"quot", '"'}, std::pair{"apos", '\''}})
            if (name == entity) code = static_cast<unsigned char>(c);
        if (name.starts_with("#")) {
            const bool hex = name.size() > 1 && (name[1] == 'x' || name[1] == 'X');
            std::from_chars(name.data() + (hex ? 2 : 1), name.data() + name.size(), code, hex ? 16 : 10);
        }
        if (code > 0 && code < 0x80)
            text += char(code);
        else
            text += value.substr(at, end + 1 - at);
        at = end + 1;
    }
    return text;
}

class Embedder {
public:
    explicit Embedder(const fs::path& page) : page_(page) {
        if (!is_file(page)) throw InputError(fmt::format("{}: cannot be opened, expected a page", page.string()));
        html_ = bytes_of(page);
    }

    std::string embedded() {
        while (at_ < html_.size()) {
            if (here("<!--")) {
                copy_through("-->");
            } else if (html_[at_] == '<' && at_ + 1 < html_.size() &&
                       std::isalpha(static_cast<unsigned char>(html_[at_ + 1]))) {
                const std::string tag = start_tag();
                if (tag == "script") copy_through("</script");
                if (tag == "style") out_ += style(take_until(html_.find("</style", at_)), page_);
            } else {
                out_ += html_[at_++];
            }
        }
        return out_;
    }

private:
    [[nodiscard]] bool here(std::string_view text) const { return html_.compare(at_, text.size(), text) == 0; }
    void copy_through(std::string_view text) {
        const std::size_t found = html_.find(text, at_);
        out_ += take_until(found == std::string::npos ? found : found + text.size());
    }
    /// The text up to `end`, a place in the page or npos, from where it goes on.
    std::string take_until(std::size_t end) {
        const std::size_t begin = std::exchange(at_, std::min(end, html_.size()));
        return html_.substr(begin, at_ - begin);
    }

    /// From "<" through ">"; returns the name of the element.
    std::string start_tag() {
        constexpr const char *kSpaces = " \n\t\r", *kNoName = " \n\t\r=>/", *kNoValue = " \n\t\r>";
        ++at_;
        std::string tag = take_until(html_.find_first_of(kNoName, at_));
        out_ += "<" + tag;
        while (at_ < html_.size() && html_[at_] != '>') {
            const std::string space = take_until(html_.find_first_not_of(kSpaces, at_));
            if (here("=") || here("/")) {
                out_ += space + html_[at_++];
                continue;
            }
            const std::string name = take_until(html_.find_first_of(kNoName, at_));
            if (name.empty() || !here("=")) {
                out_ += space + name;
                continue;
            }
            ++at_;
            std::string value;
            if (here("\"") || here("'")) {
                const char quote = html_[at_++];
                value            = take_until(html_.find(quote, at_));
                at_              = std::min(at_ + 1, html_.size());
                if (quote == '\'') value = with_double_quotes(value);
            } else {
                value = take_until(html_.find_first_of(kNoValue, at_));
            }
            if (const auto kept = attribute(tag, name, value)) out_ += fmt::format("{}{}=\"{}\"", space, name, *kept);
        }
        if (at_ < html_.size()) out_ += html_[at_++];
        return tag;
    }
    static std::string with_double_quotes(const std::string& value) {
        return boost::algorithm::replace_all_copy(value, "\"", "&quot;");
    }

    /// The attribute's value in the embedded page; nothing where the attribute is dropped.
    std::optional<std::string> attribute(std::string_view tag, std::string_view name, const std::string& value) {
        if (name == "style") return with_double_quotes(style(value, page_));
        const std::string address = without_entities(value);
        if (!is_local_file(address)) return value;
        if (name == "src" || name == "poster" || (name == "href" && tag == "link")) return data_of(address, page_);
        if (name == "data-src")
            return is_file(file_of(address, page_)) ? std::optional(data_of(address, page_)) : std::nullopt;
        if (name == "href" && (tag == "a" || tag == "area")) {
            const std::size_t fragment = address.find('#');
            if (fragment != std::string::npos && path_of_url(address.substr(0, fragment)) == page_.filename())
                return value.substr(value.find('#'));
            return std::nullopt;
        }
        return value;
    }

    static fs::path file_of(const std::string& address, const fs::path& beside) {
        return beside.parent_path() / path_of_url(address.substr(0, address.find_first_of("?#")));
    }
    static std::string data_of(const std::string& address, const fs::path& beside) {
        const fs::path file = file_of(address, beside);
        if (!is_file(file))
            throw InputError(
                fmt::format("{}: cannot be opened, expected a file that {} shows", file.string(), beside.string()));
        std::string bytes = bytes_of(file);
        if (file.extension() == ".css") bytes = style(bytes, file);
        return data_uri(media_type(file), bytes);
    }

    /// A style with the files behind its url() in it.
    static std::string style(const std::string& css, const fs::path& beside) {
        std::string text;
        for (std::size_t at = 0; at < css.size();) {
            if (css.compare(at, 4, "url(") != 0) {
                text += css[at++];
                continue;
            }
            const std::size_t end = std::min(css.find(')', at), css.size());
            std::string address   = without_entities(css.substr(at + 4, end - at - 4));
            std::erase_if(address, [](char c) { return c == '"' || c == '\'' || c == ' '; });
            text += is_local_file(address) ? "url(" + data_of(address, beside) : css.substr(at, end - at);
            at = end;
        }
        return text;
    }

    fs::path page_;
    std::string html_, out_;
    std::size_t at_ = 0;
};

}  // namespace

std::string embedded_page(const fs::path& page) { return Embedder(page).embedded(); }

std::string data_uri(std::string_view media_type, std::string_view bytes) {
    std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and the zero that the library writes behind it
    EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), reinterpret_cast<const unsigned char*>(bytes.data()),
                    static_cast<int>(bytes.size()));
    text.pop_back();
    return fmt::format("data:{};base64,{}", media_type, text);
}

}  // namespace umbra
