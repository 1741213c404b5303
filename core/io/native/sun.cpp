// This work is based on:
// Jean Meeus. Astronomical Algorithms, chapters 12 (Sidereal Time), 13 (Transformation of Coordinates), 22 (Obliquity
// of the Ecliptic) and 25 (Solar Coordinates, low accuracy: 0.01 degrees), second edition. 1998
#include "umbra/core/io/native/sun.h"

#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "umbra/core/io/native/directions.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {
namespace {

constexpr Range kLatitude{-90, 90, "an angle in degrees, from -90 (south) to 90 (north)"};
constexpr Range kLongitude{-180, 180, "an angle in degrees, from -180 (west) to 180 (east)"};
constexpr int kFirstYear = 1800, kLastYear = 2200;

/// The rest of a time while it is read from its beginning.
class TimeText {
public:
    explicit TimeText(std::string_view text) : rest_(text) {}

    /// As many digits as asked for, a number in [low, high].
    [[nodiscard]] std::optional<int> digits(std::size_t count, int low, int high) {
        if (rest_.size() < count || rest_.substr(0, count).find_first_not_of("0123456789") != std::string_view::npos)
            return std::nullopt;
        int value = 0;
        std::from_chars(rest_.data(), rest_.data() + count, value);
        rest_.remove_prefix(count);
        return value >= low && value <= high ? std::optional(value) : std::nullopt;
    }
    [[nodiscard]] bool skip(std::string_view any_of) {
        const bool found = !rest_.empty() && any_of.find(rest_.front()) != std::string_view::npos;
        if (found) rest_.remove_prefix(1);
        return found;
    }
    void skip_digits() {
        while (skip("0123456789")) {
        }
    }
    [[nodiscard]] char front() const { return rest_.empty() ? '\0' : rest_.front(); }
    [[nodiscard]] bool at_end() const { return rest_.empty(); }

private:
    std::string_view rest_;
};

/// Days since noon of 1 January 2000, universal time, of "2026-06-21T14:00:00+02:00", seconds left out or not; none for
/// any other text. Fractions of a second are left out.
std::optional<double> days_of(std::string_view written) {
    namespace chr = std::chrono;
    TimeText text(written);
    const auto year = text.digits(4, kFirstYear, kLastYear);
    if (!year || !text.skip("-")) return std::nullopt;
    const auto month = text.digits(2, 1, 12);
    if (!month || !text.skip("-")) return std::nullopt;
    const auto day = text.digits(2, 1, 31);
    if (!day || !text.skip("Tt ")) return std::nullopt;
    const chr::year_month_day date{chr::year(*year), chr::month(unsigned(*month)), chr::day(unsigned(*day))};
    const auto hour = text.digits(2, 0, 23);
    if (!date.ok() || !hour || !text.skip(":")) return std::nullopt;
    const auto minute = text.digits(2, 0, 59);
    if (!minute) return std::nullopt;
    int seconds = 0;
    if (text.skip(":")) {
        const auto given = text.digits(2, 0, 60);
        if (!given) return std::nullopt;
        seconds = *given;
        if (text.skip(".")) text.skip_digits();
    }
    int east = 0;  // minutes by which the clock is ahead of universal time
    if (!text.skip("Zz")) {
        const int sign = text.front() == '-' ? -1 : 1;
        if (!text.skip("+-")) return std::nullopt;
        const auto hours = text.digits(2, 0, 14);
        if (!hours) return std::nullopt;
        (void)text.skip(":");
        const auto minutes = text.digits(2, 0, 59);
        if (!minutes) return std::nullopt;
        east = sign * (60 * *hours + *minutes);
    }
    if (!text.at_end()) return std::nullopt;
    constexpr chr::sys_days kEpoch = chr::year(2000) / 1 / 1;
    const double whole             = double((chr::sys_days(date) - kEpoch).count());
    return whole - 0.5 + (60.0 * (60 * *hour + *minute - east) + seconds) / 86400;
}

/// Towards the sun from a place, seen without an atmosphere: x east, y up, z south; of length 1.
dvec3 towards_sun(double days, double latitude, double longitude) {
    const auto sine      = [](double degrees) { return std::sin(glm::radians(std::fmod(degrees, 360))); };
    const auto cosine    = [](double degrees) { return std::cos(glm::radians(std::fmod(degrees, 360))); };
    const double t       = days / 36525;  // Julian centuries
    const double mean    = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = 357.52911 + t * (35999.05029 - t * 0.0001537);
    const double centre  = (1.914602 - t * (0.004817 + t * 0.000014)) * sine(anomaly) +
                          (0.019993 - t * 0.000101) * sine(2 * anomaly) + 0.000289 * sine(3 * anomaly);
    const double node      = 125.04 - 1934.136 * t;
    const double nutation  = -0.00478 * sine(node);
    const double ecliptic  = mean + centre - 0.00569 + nutation;  // apparent longitude
    const double obliquity = 23.4392911 - t * (0.0130042 + t * (1.64e-7 - t * 5.04e-7)) + 0.00256 * cosine(node);
    const double sidereal  = 280.46061837 + 360.98564736629 * days + t * t * 0.000387933 + nutation * cosine(obliquity);

    // Towards the sun at the place's meridian: along the equator, to its west, along the earth's axis.
    const double x = cosine(ecliptic), y = cosine(obliquity) * sine(ecliptic);
    const double axis  = sine(obliquity) * sine(ecliptic);
    const double local = sidereal + longitude;
    const double along = x * cosine(local) + y * sine(local);
    const double west  = x * sine(local) - y * cosine(local);

    constexpr double kParallax =
        4.2635e-5;  // radians by which the sun at the horizon stands lower than from the centre
    const double up    = along * cosine(latitude) + axis * sine(latitude) - kParallax;
    const double north = axis * cosine(latitude) - along * sine(latitude);
    return glm::normalize(dvec3(-west, up, -north));
}

double angle_at(const JsonText& json, const JsonFields& f, std::string_view key, const Range& range) {
    return json.number(f.require(key), key, range);
}

}  // namespace

vec3 read_sun(const JsonText& json, const JsonValue& v) {
    const JsonFields f(json, v, "the sun", {"latitude", "longitude", "time", "north"});
    const double latitude      = angle_at(json, f, "latitude", kLatitude);
    const double longitude     = angle_at(json, f, "longitude", kLongitude);
    const JsonValue& time      = f.require("time");
    const std::string& written = json.string(time, "time");
    const auto days            = days_of(written);
    if (!days)
        json.fail(time, fmt::format("time is \"{:.40}\", expected a date of the years {} to {}, a time and its offset "
                                    "from universal time, such as 2026-06-21T12:00:00Z or 2026-06-21T14:00:00+02:00",
                                    written, kFirstYear, kLastYear));
    dvec3 north{0, 0, -1};
    if (const JsonValue* given = f.find("north")) {
        north = dvec3(read_direction(json, *given, "north"));
        if (north.y != 0)
            json.fail(*given, fmt::format("north is {}, expected a horizontal direction, whose y is 0",
                                          vector_text(vec3(north))));
        north = glm::normalize(north);
    }
    const dvec3 sun = towards_sun(*days, latitude, longitude);
    if (sun.y <= 0)
        json.fail(v, fmt::format("the sun stands {:.2f} degrees below the horizon at this place and time, expected a "
                                 "time at which it is up",
                                 glm::degrees(-std::asin(sun.y))));
    const dvec3 east = glm::cross(north, dvec3(0, 1, 0));
    return vec3(-(sun.x * east + sun.y * dvec3(0, 1, 0) - sun.z * north));
}

}  // namespace umbra
