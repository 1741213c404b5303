#include "umbra/bench/report/lecture_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "report_assets.h"
#include "umbra/bench/base/field.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

using nlohmann::json;

std::map<std::string, json, std::less<>>& all_texts() {
    static std::map<std::string, json, std::less<>> all = [] {
        std::map<std::string, json, std::less<>> texts;
        for (const auto& entry : assets::lecture_languages) texts.emplace(entry.code, json::parse(entry.texts));
        return texts;
    }();
    return all;
}

/// `names` aside, a translation has no member that English has not, and the same types. Lists may have other lengths.
void check_translation(const json& given, const json& english, const std::string& at, const std::string& file) {
    if (given.type() != english.type())
        throw InputError(fmt::format("{}: {} is {}, expected {} as in English", file, at.empty() ? "/" : at,
                                     given.type_name(), english.type_name()));
    if (!given.is_object()) return;
    for (const auto& [key, value] : given.items()) {
        if (at.empty() && key == "names") continue;
        if (!english.contains(key)) throw InputError(fmt::format("{}: {}/{}: English has no such text", file, at, key));
        check_translation(value, english.at(key), at + "/" + key, file);
    }
}

}  // namespace

const std::vector<Language>& languages() {
    static const std::vector<Language> all = [] {
        std::vector<Language> found;
        for (const auto& language : assets::lecture_languages) found.push_back({language.code});
        return found;
    }();
    return all;
}

std::optional<Language> language_named(std::string_view code) {
    const auto found = std::ranges::find(languages(), code, &Language::code);
    return found == languages().end() ? std::nullopt : std::optional(*found);
}

Language add_language(const std::filesystem::path& folder) {
    const std::string file = (folder / "texts.json").string();
    static_cast<void>(parse_json(bytes_of(file), file));  // says where it is no JSON
    const json given = json::parse(bytes_of(file));
    json texts       = all_texts().at("en");
    check_translation(given, texts, "", file);
    texts.merge_patch(given);
    const std::string code = std::filesystem::weakly_canonical(std::filesystem::absolute(folder)).filename().string();
    return {all_texts().insert_or_assign(code, std::move(texts)).first->first};
}

const json& lecture_words(Language language) { return all_texts().find(language.code)->second; }

std::string lecture_name(const std::string& english, Language language) {
    const nlohmann::json& words = lecture_words(language);
    if (const auto names = words.find("names"); names != words.end())
        if (const auto found = names->find(english); found != names->end()) return found->get<std::string>();
    if (!words.value("decimal_comma", false)) return english;
    std::string text = with_decimal_comma(english);
    boost::algorithm::replace_all(text, "; ", separator(language));
    if (text.find('=') != std::string::npos) boost::algorithm::replace_all(text, ", ", separator(language));
    return text;
}

std::string separator(Language language) { return lecture_words(language)["phrases"]["separator"]; }

}  // namespace umbra
