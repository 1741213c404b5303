// The grammar is nlohmann/json's: maintained, strict, checks UTF-8, and its event interface keeps its own stack, so
// that deep nesting cannot exhaust ours. (RapidJSON says the offset of each event, but its last release is of 2016.) It
// does not say where a value is; but its events come in the order of the text, one for each token, so a cursor that
// skips one token per event knows. Of its errors only the number of the byte and the kind are used, not the words.
#include "umbra/core/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "umbra/core/base/error.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

constexpr std::size_t kMaxDepth = 32;

class TreeBuilder {  // nlohmann's SAX interface
public:
    explicit TreeBuilder(const SourceText& source) : source_(source) {}
    JsonValue take() {
        skip(" \t\r\n");
        if (cursor_ < source_.text.size())
            source_.fail(cursor_, "not JSON: found text after the end of the scene, expected the end of the file");
        return std::move(root_);
    }

    bool null() { return leaf(nullptr); }
    bool boolean(bool b) { return leaf(b); }
    bool number_integer(std::int64_t i) { return leaf(static_cast<double>(i)); }
    bool number_unsigned(std::uint64_t u) { return leaf(static_cast<double>(u)); }
    bool number_float(double d, const std::string&) { return leaf(d); }
    bool string(std::string& s) { return leaf(std::move(s)); }
    bool binary(std::vector<std::uint8_t>&) { throw std::logic_error("JSON text holds no binary values"); }
    bool start_object(std::size_t) { return open(JsonObject{}); }
    bool start_array(std::size_t) { return open(JsonArray{}); }
    bool end_array() { return close(); }
    bool key(std::string& k) {
        std::get<JsonObject>(stack_.back()->data).push_back({token(), std::move(k), {}});
        last_ = Last::key;
        return true;
    }
    bool end_object() {
        const auto& members = std::get<JsonObject>(stack_.back()->data);
        std::vector<std::size_t> order(members.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t i, std::size_t j) { return members[i].key < members[j].key; });
        for (std::size_t i = 1; i < order.size(); ++i)
            if (members[order[i]].key == members[order[i - 1]].key)
                source_.fail(members[order[i]].offset,
                             fmt::format("the key \"{}\" is given twice, expected once", members[order[i]].key));
        return close();
    }
    bool parse_error(std::size_t bytes_read, const std::string& last, const nlohmann::json::exception& e) {
        constexpr int kNumberOverflow = 406;  // nlohmann's documented number of that exception
        const Gap gap                 = skip_separators();
        const std::string& t          = source_.text;
        if (e.id == kNumberOverflow)
            source_.fail(cursor_, fmt::format("the number {} is too large, expected at most 1.8e308", last));
        if (cursor_ >= t.size())
            source_.fail(cursor_, fmt::format("not JSON: the file is cut off, expected {}", gap.expected));
        const bool in_string = t[cursor_] == '"' && gap.may_be_string;
        if (in_string) fail_in_string(std::min(bytes_read > 0 ? bytes_read - 1 : 0, t.size()));
        source_.fail(cursor_,
                     fmt::format("not JSON: found {}, expected {}{}", found_at(cursor_), gap.expected, hint(cursor_)));
    }

private:
    /// The tokens that the grammar allows at the cursor.
    struct Gap {
        std::string_view expected;
        bool may_be_string = false;
    };

    /// Moves the cursor from the end of the last token that was accepted over the separators that may follow it.
    Gap skip_separators() {
        constexpr std::string_view kBlank = " \t\r\n";
        const auto take                   = [&](char separator) {
            skip(kBlank);
            const bool there = cursor_ < source_.text.size() && source_.text[cursor_] == separator;
            if (there) ++cursor_;
            skip(kBlank);
            return there;
        };
        if (stack_.empty()) {
            skip(kBlank);
            return last_ == Last::none ? Gap{"a value", true} : Gap{"the end of the file"};
        }
        const bool in_object = std::holds_alternative<JsonObject>(stack_.back()->data);
        switch (last_) {
            case Last::key: return take(':') ? Gap{"a value", true} : Gap{"\":\""};
            case Last::open:
                skip(kBlank);
                return in_object ? Gap{"a key in quotes or \"}\"", true} : Gap{"a value or \"]\"", true};
            default: break;
        }
        if (take(',')) return in_object ? Gap{"a key in quotes", true} : Gap{"a value", true};
        return {in_object ? "\",\" or \"}\"" : "\",\" or \"]\""};
    }

    /// `at` is the byte that the parser could not accept within the string at the cursor.
    [[noreturn]] void fail_in_string(std::size_t at) const {
        const std::string& t = source_.text;
        if (at >= t.size()) source_.fail(at, "not JSON: the file is cut off within a string, expected a closing quote");
        const auto c = static_cast<unsigned char>(t[at]);
        if (c == '\n' || c == '\r') source_.fail(at, "not JSON: a line ends within a string, expected a closing quote");
        if (c < 0x20)
            source_.fail(at,
                         fmt::format("not JSON: the control character {} in a string, expected \"\\u{:04x}\"", c, c));
        const auto is_ascii = [&](std::size_t k) { return static_cast<unsigned char>(t[k]) < 0x80; };
        if (!is_ascii(at) || !is_ascii(at - 1)) source_.fail(at, "not JSON: this byte is not UTF-8");
        source_.fail(at,
                     "not JSON: this may not follow a backslash, expected one of \" \\ / b f n r t, or u and four "
                     "hexadecimal digits");
    }

    /// The token that begins at `at`, as a message shows it.
    [[nodiscard]] std::string found_at(std::size_t at) const {
        const std::string& t = source_.text;
        if (std::string_view("{}[],:").find(t[at]) != std::string_view::npos) return fmt::format("\"{}\"", t[at]);
        if (t[at] == '"') return "a string";
        return in_quotes(std::string_view(t).substr(at, std::min(t.find_first_of(" \t\r\n,:]}\"", at), t.size()) - at));
    }

    [[nodiscard]] std::string_view hint(std::size_t at) const {
        const std::string_view rest = std::string_view(source_.text).substr(at);
        if (rest.starts_with('/') || rest.starts_with('#')) return " (JSON has no comments; a \"note\" key is allowed)";
        if (rest.starts_with('N') || rest.starts_with('I') || rest.starts_with("-I") || rest.starts_with("nan") ||
            rest.starts_with("inf"))
            return " (JSON has neither NaN nor infinity)";
        const auto before = at == 0 ? std::string::npos : source_.text.find_last_not_of(" \t\r\n", at - 1);
        if ((rest[0] == '}' || rest[0] == ']') && before != std::string::npos && source_.text[before] == ',')
            return " (remove the comma before it)";
        return "";
    }

    void skip(std::string_view these) {
        cursor_ = std::min(source_.text.find_first_not_of(these, cursor_), source_.text.size());
    }

    /// Where the next token begins; the cursor moves past it. The grammar was checked before.
    std::size_t token() {
        skip(" \t\r\n,:");
        const std::size_t begin = cursor_;
        const std::string& t    = source_.text;
        switch (t[begin]) {
            case '"':
                for (++cursor_; t[cursor_] != '"'; ++cursor_) cursor_ += t[cursor_] == '\\';
                ++cursor_;
                break;
            case '{':
            case '}':
            case '[':
            case ']': ++cursor_; break;
            default: cursor_ = std::min(t.find_first_of(" \t\r\n,:]}", cursor_), t.size());
        }
        return begin;
    }

    /// Where the next value belongs.
    JsonValue& slot() {
        if (stack_.empty()) return root_;
        if (auto* array = std::get_if<JsonArray>(&stack_.back()->data)) return array->emplace_back();
        return std::get<JsonObject>(stack_.back()->data).back().value;
    }
    template <class T>
    JsonValue& put(T&& data) {
        JsonValue& v = slot();
        v.offset     = token();
        v.data       = std::forward<T>(data);
        return v;
    }
    template <class T>
    bool leaf(T&& data) {
        put(std::forward<T>(data));
        last_ = Last::value;
        return true;
    }
    template <class T>
    bool open(T&& empty) {
        JsonValue& v = put(std::forward<T>(empty));
        if (stack_.size() >= kMaxDepth) source_.fail(v.offset, fmt::format("nested deeper than {} levels", kMaxDepth));
        stack_.push_back(&v);  // stays where it is: its parent grows only after it is closed
        last_ = Last::open;
        return true;
    }
    bool close() {
        token();
        stack_.pop_back();
        last_ = Last::value;
        return true;
    }

    enum class Last : std::uint8_t { none, open, key, value };

    const SourceText& source_;
    std::size_t cursor_ = 0;           ///< after the last token that was accepted
    Last last_          = Last::none;  ///< that token; closing brackets end a value
    JsonValue root_;
    std::vector<JsonValue*> stack_;
};

JsonValue parse(const SourceText& source) {
    const std::string& t = source.text;
    if (t.starts_with("\xef\xbb\xbf") || t.starts_with("\xff\xfe") || t.starts_with("\xfe\xff"))
        source.fail(0, "the file begins with a byte order mark, expected UTF-8 without one");
    TreeBuilder builder(source);
    nlohmann::json::sax_parse(t.begin(), t.end(), &builder);
    return builder.take();
}

std::string describe(const JsonValue& v) {
    static constexpr std::string_view names[] = {"null",     "true or false", "a number",
                                                 "a string", "a list",        "an object"};
    if (const auto* s = std::get_if<std::string>(&v.data)) return fmt::format("the string \"{:.40}\"", *s);
    if (const auto* d = std::get_if<double>(&v.data)) return fmt::format("the number {:g}", *d);
    if (const auto* a = std::get_if<JsonArray>(&v.data))
        return fmt::format("a list of {} {}", a->size(), a->size() == 1 ? "value" : "values");
    return std::string(names[v.data.index()]);
}

// [Vladimir Levenshtein, Binary Codes Capable of Correcting Deletions, Insertions, and Reversals, 1966]
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0]               = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t above = row[j + 1];
            row[j + 1]              = std::min({above + 1, row[j] + 1, diagonal + (a[i] != b[j])});
            diagonal                = above;
        }
    }
    return row.back();
}

std::string nearest(std::string_view found, const std::vector<std::string_view>& known) {
    if (found.size() > 40) return "";
    std::string_view best;
    std::size_t distance = 3;  // no farther
    for (const std::string_view k : known)
        if (const std::size_t d = edit_distance(found, k); d < std::min(distance, k.size())) best = k, distance = d;
    return best.empty() ? "" : fmt::format("did you mean \"{}\"? ", best);
}

}  // namespace

JsonText::JsonText(SourceText source) : source_(std::move(source)), root_(parse(source_)) {}

void JsonText::wrong_type(const JsonValue& v, std::string_view what, std::string_view expected) const {
    fail(v, fmt::format("{} is {}, expected {}", what, describe(v), expected));
}
const JsonObject& JsonText::object(const JsonValue& v, std::string_view what) const {
    const auto* o = std::get_if<JsonObject>(&v.data);
    if (!o) wrong_type(v, what, "an object {...}");
    return *o;
}
const JsonArray& JsonText::array(const JsonValue& v, std::string_view what, std::string_view expected) const {
    const auto* a = std::get_if<JsonArray>(&v.data);
    if (!a) wrong_type(v, what, expected);
    return *a;
}
const std::string& JsonText::string(const JsonValue& v, std::string_view what) const {
    const auto* s = std::get_if<std::string>(&v.data);
    if (!s) wrong_type(v, what, "a string");
    return *s;
}
bool JsonText::boolean(const JsonValue& v, std::string_view what) const {
    const auto* b = std::get_if<bool>(&v.data);
    if (!b) wrong_type(v, what, "true or false");
    return *b;
}
double JsonText::number(const JsonValue& v, std::string_view what, const Range& range) const {
    const auto* d = std::get_if<double>(&v.data);
    if (!d) wrong_type(v, what, range.words);
    if (!range.holds(*d)) fail(v, fmt::format("{} is {}, expected {}", what, *d, range.words));
    return *d;
}
int JsonText::integer(const JsonValue& v, std::string_view what, int min, int max) const {
    const std::string words = fmt::format("a whole number from {} to {}", min, max);
    const double d          = number(v, what, {double(min), double(max), words});
    if (d != std::floor(d)) fail(v, fmt::format("{} is {:g}, expected {}", what, d, words));
    return static_cast<int>(d);
}
dvec3 JsonText::vector(const JsonValue& v, std::string_view what, const Range& range) const {
    const auto* a = std::get_if<JsonArray>(&v.data);
    if (!a || a->size() != 3) wrong_type(v, what, "three numbers [x, y, z]");
    return {number((*a)[0], what, range), number((*a)[1], what, range), number((*a)[2], what, range)};
}
std::size_t JsonText::choice(const JsonValue& v, std::string_view what,
                             const std::vector<std::string_view>& choices) const {
    const std::string& s = string(v, what);
    const auto found     = std::find(choices.begin(), choices.end(), s);
    if (found == choices.end()) unknown(v.offset, what, s, choices);
    return static_cast<std::size_t>(found - choices.begin());
}
void JsonText::unknown(std::size_t offset, std::string_view what, std::string_view found,
                       const std::vector<std::string_view>& known) const {
    source_.fail(offset, fmt::format("unknown {} \"{:.40}\" ({}known: {})", what, found, nearest(found, known),
                                     fmt::join(known, ", ")));
}

JsonFields::JsonFields(const JsonText& text, const JsonValue& value, std::string_view what,
                       const std::vector<std::string_view>& known)
    : text_(text), value_(value), members_(text.object(value, what)), what_(what) {
    for (const JsonMember& m : members_)
        if (m.key != "note" && std::find(known.begin(), known.end(), m.key) == known.end())
            text.unknown(m.offset, fmt::format("key of {}", what), m.key, known);
}
const JsonValue* JsonFields::find(std::string_view key) const {
    const auto m = std::find_if(members_.begin(), members_.end(), [&](const JsonMember& x) { return x.key == key; });
    return m == members_.end() ? nullptr : &m->value;
}
const JsonValue& JsonFields::require(std::string_view key) const {
    const JsonValue* v = find(key);
    if (!v) text_.fail(value_, fmt::format("{} has no \"{}\"", what_, key));
    return *v;
}
double JsonFields::number(std::string_view key, const Range& range, double fallback) const {
    const JsonValue* v = find(key);
    return v ? text_.number(*v, key, range) : fallback;
}
int JsonFields::integer(std::string_view key, int min, int max, int fallback) const {
    const JsonValue* v = find(key);
    return v ? text_.integer(*v, key, min, max) : fallback;
}
bool JsonFields::boolean(std::string_view key, bool fallback) const {
    const JsonValue* v = find(key);
    return v ? text_.boolean(*v, key) : fallback;
}
std::string JsonFields::string(std::string_view key, std::string_view fallback) const {
    const JsonValue* v = find(key);
    return v ? text_.string(*v, key) : std::string(fallback);
}
void JsonFields::exclude(std::string_view key, std::string_view other) const {
    const JsonValue *a = find(key), *b = find(other);
    if (a && b)
        text_.fail(a->offset > b->offset ? *a : *b,
                   fmt::format("{} has both \"{}\" and \"{}\", expected one of them", what_, key, other));
}

}  // namespace umbra
