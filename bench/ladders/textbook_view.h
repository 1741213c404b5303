// The textbook form of each method beside its default form: which breaks earlier, and what the difference takes in
// time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {

/// Whether an entry of `methods` of a ladder is the textbook form of a method whose default form was climbed, too.
[[nodiscard]] bool is_textbook_twin(const LadderRecord& ladder, const ClimbRecord& climbed);

/// How the textbook form of a method fared on a ladder beside the default form.
enum class Textbook : std::uint8_t {
    earlier,      ///< it breaks at an earlier rung, or alone
    later,        ///< it breaks at a later rung, or not at all where the default form does
    same,         ///< both break at the same rung, or neither does
    not_compared  ///< one breaks where the other has no answer that could be judged
};
struct TextbookClimb {
    Textbook outcome = Textbook::same;
    int rungs        = 0;  ///< that the default form holds for longer; negative where it breaks earlier
};
[[nodiscard]] TextbookClimb compare_with_textbook(const LadderRecord& ladder, const ClimbRecord& textbook,
                                                  const ClimbRecord& by_default);

/// Counts and times by method, and a row for each ladder where the two forms differ (textbook_table.html); false where
/// no ladder has both forms of a method. `page` as for ladder_table_view.
[[nodiscard]] nlohmann::json textbook_view(const LaddersRecord& record, const std::string& page);

}  // namespace umbra
