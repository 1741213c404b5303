// A page with everything that it shows inside one file: to be sent, uploaded or kept without its folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace umbra {

/// The page with the local files that src=, data-src= (which scripts load) and links to styles name as data URIs, also
/// those behind url() in styles. Links to other local files are dropped, their text stays; addresses with a scheme and
/// within the page are left as they are. For pages that this program wrote: any file that the page names is read.
/// Throws InputError where the page or such a file cannot be read; a data-src that is missing is dropped.
[[nodiscard]] std::string embedded_page(const std::filesystem::path& page);

/// "data:MEDIA_TYPE;base64,...": a file within a page.
[[nodiscard]] std::string data_uri(std::string_view media_type, std::string_view bytes);

}  // namespace umbra
