// How fast the machine is at this moment.
#pragma once

namespace umbra {

/// A fixed amount of 64-bit arithmetic and memory traffic on all threads, about 20 ms on two cores: what other times of
/// the same minute are relative to.
void calibration_work();

}  // namespace umbra
