#include "umbra/bench/pages/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace umbra {

std::string superscript(int value) {
    static constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string raised;
    for (const char c : std::to_string(value)) raised += c == '-' ? "⁻" : digits[std::size_t(c - '0')];
    return raised;
}

std::string score(std::optional<double> value) {
    if (!value) return kNone;
    const double size      = std::abs(*value);
    const std::string sign = *value < 0 ? "−" : "";
    if (size == 0) return "0";
    const int exponent = int(std::floor(std::log10(size)));
    if (exponent >= -4 && exponent < 6) return fmt::format("{}{:.{}f}", sign, size, std::max(0, 2 - exponent));
    const std::string rounded = fmt::format("{:.1e}", size);  // 1.2e-05
    const auto e              = rounded.find('e');
    return fmt::format("{}{}·10{}", sign, rounded.substr(0, e), superscript(std::stoi(rounded.substr(e + 1))));
}

std::string milliseconds(std::optional<double> ms) { return ms && *ms > 0 && *ms < 0.001 ? "< 0.001" : score(ms); }

std::string count(std::optional<double> value) {
    if (!value) return kNone;
    std::string digits = fmt::format("{:.0f}", *value);
    for (auto at = std::ptrdiff_t(digits.size()) - 3; at > 0; at -= 3)
        if (digits[std::size_t(at) - 1] != '-') digits.insert(std::size_t(at), "\u202f");
    return digits;
}

std::string percent(std::optional<double> fraction) {
    if (!fraction) return kNone;
    const double tenths = std::round(*fraction * 1000);
    if (*fraction > 0 && tenths == 0) return "< 0.1";
    if (*fraction < 1 && tenths == 1000) return "> 99.9";
    return fmt::format("{:g}", tenths / 10);
}

std::string mebibytes(std::optional<double> bytes) {
    return bytes ? score(*bytes / (1024.0 * 1024.0)) : std::string(kNone);
}

std::string in_words(std::string_view key) {
    std::string words(key);
    std::replace(words.begin(), words.end(), '_', ' ');
    return words;
}

std::string kind_in_words(const std::string& kind) {
    const bool area = kind == "rectangle" || kind == "disk" || kind == "sphere";
    return kind.empty() ? kind : kind + (area ? " light (area)" : " light");
}

std::string place_in_words(const std::string& place) {
    if (place == "at_infinity") return "at infinity";
    if (place == "outside_view") return "outside the view";
    if (place == "inside_view") return "inside the view";
    if (place == "at_eye") return "at the eye";
    return in_words(place);
}

std::string counted(double n, const std::string& noun) {
    return fmt::format("{} {}{}", count(n), noun, n == 1 ? "" : "s");
}

std::string with_decimal_comma(std::string text) {
    const auto digit = [](char c) { return '0' <= c && c <= '9'; };
    for (std::size_t k = 1; k + 1 < text.size(); ++k)
        if (text[k] == '.' && digit(text[k - 1]) && digit(text[k + 1])) text[k] = ',';
    return text;
}

std::string without_folders(const std::string& command) {
    std::string shown;
    for (std::size_t at = 0; at < command.size();) {
        const std::size_t end  = std::min(command.find(' ', at), command.size());
        const std::string word = command.substr(at, end - at);
        const std::filesystem::path path(word.ends_with('/') ? word.substr(0, word.size() - 1) : word);
        shown += path.is_absolute() ? path.filename().string() : word;
        if (end < command.size()) shown += ' ';
        at = end + 1;
    }
    return shown;
}

std::string url(const std::filesystem::path& path) {
    std::string encoded;
    for (const char c : path.generic_string()) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                           c == '.' || c == '-' || c == '_' || c == '~';
        encoded += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return encoded;
}

std::filesystem::path path_of_url(const std::string& url) {
    std::string path;
    for (std::size_t i = 0; i < url.size(); ++i) {
        int byte = 0;
        if (url[i] == '%' && i + 2 < url.size() &&
            std::from_chars(url.data() + i + 1, url.data() + i + 3, byte, 16).ptr == url.data() + i + 3) {
            path += static_cast<char>(byte);
            i += 2;
        } else {
            path += url[i];
        }
    }
    return path;
}

std::string utf8_text(const std::string& text) {
    return nlohmann::json::parse(nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string xml_text(const std::string& text) {
    std::string escaped;
    for (const char c : utf8_text(text)) switch (c) {
            case '&': escaped += "&amp;"; break;
            case '<': escaped += "&lt;"; break;
            case '>': escaped += "&gt;"; break;
            case '"': escaped += "&quot;"; break;
            case '\n': escaped += "&#10;"; break;
            default: escaped += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
        }
    return escaped;
}

std::string junit_text(const std::string& suite, const std::vector<JunitCase>& cases) {
    const auto with  = [&](const char* problem) { return std::ranges::count(cases, problem, &JunitCase::problem); };
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
        "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n",
        xml_text(suite), cases.size(), with("failure"), with("error"));
    for (const JunitCase& one : cases) {
        text += fmt::format("<testcase classname=\"{}\" name=\"{}\"", xml_text(one.classname), xml_text(one.name));
        text += one.problem.empty()
                    ? "/>\n"
                    : fmt::format(">\n<{0} type=\"{1}\" message=\"{2}\">{3}</{0}>\n</testcase>\n", one.problem,
                                  xml_text(one.type), xml_text(one.message), xml_text(one.text));
    }
    return text + "</testsuite>\n</testsuites>\n";
}

}  // namespace umbra
