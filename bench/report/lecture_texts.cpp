#include "umbra/bench/report/lecture_texts.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "report_assets.h"

namespace umbra {

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

const nlohmann::json& lecture_words(Language language) {
    static const std::map<std::string_view, nlohmann::json> all = [] {
        std::map<std::string_view, nlohmann::json> texts;
        for (const auto& entry : assets::lecture_languages) texts[entry.code] = nlohmann::json::parse(entry.texts);
        return texts;
    }();
    return all.at(language.code);
}

std::string lecture_name(const std::string& english, Language language) {
    const nlohmann::json& words = lecture_words(language);
    const auto names            = words.find("names");
    return names == words.end() ? english : names->value(english, english);
}

}  // namespace umbra
