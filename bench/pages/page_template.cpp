#include "umbra/bench/pages/page_template.h"

#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "report_assets.h"

namespace umbra {
namespace {

using nlohmann::json;

/// Empty strings and lists are false to a template, so that {{#x}} asks whether there is anything to show. Whether a list
/// `x` holds anything is has_x, unless the view has a value for that.
kainjow::mustache::data template_data(const json& view) {
    if (view.is_boolean()) return view.get<bool>();
    if (view.is_string()) {
        if (view.get_ref<const std::string&>().empty()) return false;
        return view.get<std::string>();
    }
    if (view.is_array()) {
        kainjow::mustache::data list(kainjow::mustache::data::type::list);
        for (const json& item : view) list << template_data(item);
        return list;
    }
    kainjow::mustache::data object;
    for (const auto& entry : view.items()) {
        object.set(entry.key(), template_data(entry.value()));
        const std::string has = "has_" + entry.key();
        if (entry.value().is_array() && !view.contains(has)) object.set(has, !entry.value().empty());
    }
    return object;
}

/// Settings that are a row's head may break between their words: "shadow_zbuffer:resolution=64" behind "_", ":", "=".
std::string with_breaks_in_heads(const std::string& html) {
    constexpr std::string_view kHead = "<th scope=\"row\">", kEnd = "</th>", kCode = "<code>", kCodeEnd = "</code>";
    std::string broken;
    bool in_head = false, in_code = false;
    for (std::size_t at = 0; at < html.size(); ++at) {
        const auto here = [&](std::string_view tag) { return html.compare(at, tag.size(), tag) == 0; };
        if (html[at] == '<') {
            if (here(kHead)) in_head = true;
            if (here(kEnd)) in_head = false;
            if (here(kCode)) in_code = true;
            if (here(kCodeEnd)) in_code = false;
        }
        broken += html[at];
        if (in_head && in_code && std::string_view("_:=,").find(html[at]) != std::string_view::npos) broken += "<wbr>";
    }
    return broken;
}

}  // namespace

std::string render_page(std::string_view page, const PageHead& head, json view) {
    view["head_title"]           = head.title;
    view["root"]                 = head.root;
    view["scripts"]              = head.scripts;
    view["language"]             = head.language;
    kainjow::mustache::data data = template_data(view);
    for (const auto& [name, text] : assets::page_parts) data.set(std::string(name), std::string(text));
    kainjow::mustache::mustache text{std::string(page)};
    const std::string html = text.render(data);
    if (!text.is_valid()) throw std::logic_error("report template: " + text.error_message());
    return with_breaks_in_heads(html);
}

void write_page_assets(const std::filesystem::path& folder, const std::vector<std::string>& scripts,
                       StagedFiles& staged) {
    staged.write(folder / "report.css", assets::report_css);
    for (const auto& [name, content] : {std::pair{"slider.js", assets::slider_js},
                                        {"compare.js", assets::compare_js},
                                        {"finder.js", assets::finder_js},
                                        {"pictures.js", assets::pictures_js}})
        for (const std::string& script : scripts)
            if (script == name) staged.write(folder / name, content);
}

void write_page(const std::filesystem::path& folder, std::string_view page, const PageHead& head, json view,
                StagedFiles& staged) {
    staged.write(folder / "index.html", render_page(page, head, std::move(view)));
    write_page_assets(folder, head.scripts, staged);
}

}  // namespace umbra
