// Pages from templates (bench/pages/assets/*.html) and the views that fill them.
//
// The template engine is Mustache (kainjow's header, packaged by Debian). It escapes by default, and every name,
// sentence and warning on a page comes from a file. No template uses the unescaped form.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/staged_files.h"

namespace umbra {

/// What the head of a page holds.
struct PageHead {
    std::string title{};                 ///< of the browser's tab
    std::vector<std::string> scripts{};  ///< "slider.js", ...: files of bench/pages/assets
    std::string root{};                  ///< address of the folder of style and scripts, seen from the page; "" or "x/"
    std::string language = "en";         ///< of the page's text, as HTML names it
};

/// A page from its template. Parts that pages share (bench/pages/assets/parts) are partials, named as their files. Of a
/// view's values, strings, lists, objects, true and false have a meaning; an empty string or list is false.
/// Beside each list `x` is has_x, true where it holds anything, for what stands around all of its items.
[[nodiscard]] std::string render_page(std::string_view page, const PageHead& head, nlohmann::json view);

/// Style and scripts of pages with these heads, written to `folder`. Throws InputError.
void write_page_assets(const std::filesystem::path& folder, const std::vector<std::string>& scripts,
                       StagedFiles& staged);

/// folder/index.html from its template, with style and scripts beside it: the head's root is "". Throws InputError.
void write_page(const std::filesystem::path& folder, std::string_view page, const PageHead& head, nlohmann::json view,
                StagedFiles& staged);

}  // namespace umbra
