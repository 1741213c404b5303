#include "umbra/bench/report/lecture_shows.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "report_assets.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/number_from.h"

namespace umbra {
namespace {

using nlohmann::json;

std::vector<LectureValue> values_from(const json& values) {
    std::vector<LectureValue> all;
    for (const json& value : values) all.push_back({value.value("name", ""), value["path"], value.value("frame", "")});
    return all;
}

std::optional<LectureShow> show_from(const json& topic) {
    if (!topic.contains("pictures")) return std::nullopt;
    LectureShow show{topic.value("study", ""), values_from(topic["pictures"]), {}, topic.value("shadows", true)};
    for (const json& figure : topic.value("figures", json::array()))
        show.figures.push_back({figure["what"], figure["kind"], values_from(figure["values"])});
    return show;
}

Field entry(const Field& array, std::string_view name) {
    const std::vector<Field> items = array.items();
    if (const auto number = number_from<std::size_t>(name)) return *number < items.size() ? items[*number] : Field{};
    const auto found = std::ranges::find_if(items, [&](const Field& item) { return item["name"].text() == name; });
    return found == items.end() ? Field{} : *found;
}

std::string figure_of(const Field& value, std::string_view kind) {
    if (kind == "count") return count(value.number());
    if (kind == "percent") return percent(value.number());
    return score(value.number());
}

}  // namespace

const std::vector<LectureRow>& lecture_rows() {
    static const std::vector<LectureRow> rows = [] {
        std::vector<LectureRow> all;
        const json data = json::parse(assets::topics_json);
        for (const json& topic : data["topics"])
            all.push_back({topic["id"], topic["source"], topic.value("scene", ""), topic.value("test", ""),
                           topic.value("code", ""), topic["state"], show_from(topic)});
        return all;
    }();
    return rows;
}

Field value_at(const Field& root, std::string_view path) {
    Field at = root;
    while (!path.empty() && at.present()) {
        const std::string_view name = path.substr(0, path.find('.'));
        path.remove_prefix(std::min(path.size(), name.size() + 1));
        at = at.is_array() ? entry(at, name) : at[name];
    }
    return at;
}

std::string number_in_words(const std::string& number, Language language) {
    return lecture_words(language)["decimal_comma"].get<bool>() ? with_decimal_comma(number) : number;
}

std::string score_in_words(std::optional<double> value, Language language) {
    return number_in_words(score(value), language);
}

std::string figure_in_words(const LectureFigure& figure, const std::function<Field(const std::string& frame)>& root_of,
                            Language language) {
    std::string words;
    for (const LectureValue& value : figure.values) {
        const Field there = value_at(root_of(value.frame), value.path);
        if (!there.present()) continue;
        words += words.empty() ? ": " : separator(language);
        if (!value.name.empty()) words += lecture_name(value.name, language) + ": ";
        words += number_in_words(figure_of(there, figure.kind), language);
    }
    if (words.empty()) return "";
    const bool named = !figure.values.front().name.empty();  // then each has a colon of its own
    return lecture_name(figure.what, language) + (named ? " –" + words.substr(1) : words) + ".";
}

}  // namespace umbra
