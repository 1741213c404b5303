// A bias study as a page: a heat map per scene, and the errors of notable settings.
#pragma once

#include "umbra/bench/studies/bias/bias_record.h"
#include "umbra/bench/studies/study_report.h"

namespace umbra {

/// Of the record of `umbra bias` alone.
[[nodiscard]] StudyReport bias_report(const BiasRecord& record);

}  // namespace umbra
