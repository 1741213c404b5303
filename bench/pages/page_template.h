// Pages from templates (bench/report/*.html) and the views that fill them.
//
// The template engine is Mustache (kainjow's header, packaged by Debian): it escapes by default, and every name,
// sentence and warning on a page comes out of a file. No template uses its unescaped form.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace umbra {

/// A page from its template; the parts that pages share are partials, named as their files. Of a view's values, only
/// strings, lists, objects and true and false mean something.
[[nodiscard]] std::string render_page(std::string_view page, const nlohmann::json& view);

}  // namespace umbra
