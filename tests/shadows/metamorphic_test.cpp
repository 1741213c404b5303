// Tests without a reference: scenes are changed in ways that leave every S_j as it was, or change it by a known rule.
//
// kRelations says for each relation and kind of method (shadows/metamorphic.def) what must be equal, and why. Scenes:
// the known ones, those of scenes/ that need no fetched mesh, or the files named by UMBRA_METAMORPHIC_SCENES (separated
// by blanks), for which a table of what was found is printed:
//     UMBRA_METAMORPHIC_SCENES="a.obj b.gltf" metamorphic_test
//
// Points at which the segment to the light touches an edge or a vertex and nothing more (`exact` knows) are on a
// shadow's boundary: arithmetic that rounds may answer either way there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/asked.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/metamorphic.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

// ---- what must be equal --------------------------------------------------------------------------------------------

enum class Same : std::uint8_t {
    /// s and `defined`, bit for bit, at every point.
    bits,
    /// The same but at points that touch, before or after. In double (or, for rays, in float about the scene's centre)
    /// an answer turns within some 2^-46 (2^-22) of a boundary; no point of these scenes lies so close without being
    /// on it.
    sides,
    /// Vertices and lights were rounded by 2^-25 of their size. A shadow's boundary moves by that, times at most
    /// (1 + distance to the receiver / distance to the light) / sine of incidence: a fraction 2^-10 of a pixel at the
    /// factor 2^8. So few points change, kRoundedShare of all and two more, and all in the edge band if the method says
    /// that it is exact. (A ray that starts at a crease may start on the other side.)
    rounded,
    /// The light's map of depth lies otherwise over the scene: its samples, a hundredth of the picture's pixels, move
    /// boundaries by a pixel at most, and nothing else. Points may change in the edge bands of both answers, and some
    /// outside: a shadow smaller than a pixel has no band, nor has one among pixels that face away.
    map,
    /// Other samples of the same light, hence other noise: the mean difference is 0 (z-test at kZ) and its square no
    /// larger than two independent estimates of the worst variance make it.
    samples,
    /// Other, fixed points of the same light, 16 of them: a straight shadow edge leaves some 16^-3/4 = 0.13 more or
    /// fewer on one side than its area says, and two edges twice that, before and after. Over the positions of an edge
    /// that sums up to the distance between the centroids of the points and the light, less than 1/32 of its size.
    pattern,
    /// Within the sum of the brackets' half-widths, and the rounding of float.
    brackets,
    /// The hard light's answer wherever that is the same within 1.5 pixels all around.
    away_from_edges,
    /// Cannot hold; another relation says what holds instead.
    nothing,
};

constexpr double kRoundedShare = 0x1p-12;
constexpr double kMapShare     = 0.03;
constexpr double kMapOutside   = 0.002;
/// Triangles that lie in one plane except for the rounding of their file make one plane or several, as the largest
/// among them tell: planar_projection may cover other points when they are cut or turned. What it covers must be the
/// same.
constexpr double kCoverageShare = 0.05;
constexpr double kZ             = 5;  ///< two-sided false alarms of a normal variable: 6e-7 a plane

/// What shadows/metamorphic.def says of methods.
enum class Arithmetic : std::uint8_t { signs, doubles, map, floats };
enum class AreaLights : std::uint8_t { brackets, pattern, samples, centre };
enum class Batch : std::uint8_t { apart, rounds };
struct Kind {
    std::string_view method, settings;
    Arithmetic arithmetic;
    AreaLights area_lights;
    Batch batch;
};
const Kind kKinds[] = {
#define METAMORPHIC(method, settings, arithmetic, area_lights, batch) \
    {#method, settings, Arithmetic::arithmetic, AreaLights::area_lights, Batch::batch},
#include "umbra/shadows/metamorphic.def"
#undef METAMORPHIC
};

/// Whom a relation is about, by what they make of area lights.
enum class About : std::uint8_t { all, seeing_area, taking_centre };

struct Relation {
    std::string_view name;
    Changed (*change)(const Question&);
    Question (*base)(const Question&);  ///< what it starts from; null: the scene itself
    Same signs, doubles, map, floats;
    About about = About::all;
};

// Scale by a power of two: all arithmetic is the same except for exponents, so that only thresholds that are not
//     lengths of the scene, and samples that depend on anything but the point's number, could tell.
// Other motions and scales, exact in themselves: `exact` decides exact signs, which stay. Rays and planes are rounded
//     elsewhere. A map moves and grows with the scene; where the scene turns, its window is computed again.
// Order: what occludes does not depend on which triangle is tested first. Sums over triangles, and edges that run from
//     the lower vertex, round otherwise in double; a map keeps the nearest of many. With lights in another order,
//     samples are others.
// Cut triangles: the same surface. A segment through one of the new edges touches where it crossed before.
// Area lights cut: S is a mean over the light's area. Methods that take the light's centre cannot know; for them S is
//     that of a point light at the centre, and 0 where the centre is behind the point's plane ("grown").
// Shrunk: every part of the light tends to its centre.
constexpr Same bits = Same::bits, sides = Same::sides, rounded = Same::rounded, map = Same::map,
               nothing = Same::nothing, away = Same::away_from_edges;
const Relation kRelations[] = {
    // Name, change, base; signs, doubles, map, floats; about.
    {"scaled by 2^-30", [](const Question& a) { return scaled(a, 0x1p-30); }, nullptr, bits, bits, bits, bits},
    {"scaled by 2^11", [](const Question& a) { return scaled(a, 0x1p11); }, nullptr, bits, bits, bits, bits},
    {"scaled by 2^40", [](const Question& a) { return scaled(a, 0x1p40); }, nullptr, bits, bits, bits, bits},
    {"scaled by 3", [](const Question& a) { return scaled(a, 3); }, nullptr, bits, sides, sides, sides},
    {"scaled by 0.7", [](const Question& a) { return scaled(a, 0.7); }, nullptr, rounded, rounded, map, rounded},
    {"axes cycled", axes_cycled, nullptr, bits, sides, map, sides},
    {"quarter turn", quarter_turn, nullptr, bits, sides, map, sides},
    {"moved", moved, nullptr, bits, sides, sides, sides},
    {"turned and moved", turned_and_moved, nullptr, rounded, rounded, map, rounded},
    {"mirrored", mirrored, nullptr, bits, sides, map, sides},
    {"triangles shuffled", triangles_shuffled, nullptr, bits, sides, bits, bits},
    {"objects reversed", objects_reversed, nullptr, bits, sides, bits, bits},
    {"lights reversed", lights_reversed, nullptr, bits, bits, bits, sides},
    {"triangles split", triangles_split, nullptr, sides, sides, map, sides},
    {"subdivided", subdivided, nullptr, sides, sides, map, sides},
    {"rectangles split", rectangles_split, with_rectangles, sides, sides, map, sides, About::seeing_area},
    {"light shrunk", [](const Question& a) { return lights_grown(a, 0x1p-20); }, with_point_lights, away, away, map,
     away, About::seeing_area},
    {"light grown", [](const Question& a) { return lights_grown(a, 0x1p-3); }, with_point_lights, nothing, sides, map,
     sides, About::taking_centre},
};

/// What the table says, for this kind of light and for what rounding the change took.
Same must_be(const Relation& relation, const Kind& method, LightKind kind, bool exact) {
    const bool centre = method.area_lights == AreaLights::centre;
    if ((relation.about == About::seeing_area && centre) || (relation.about == About::taking_centre && !centre))
        return nothing;
    const bool signs = method.arithmetic == Arithmetic::signs, by_map = method.arithmetic == Arithmetic::map;
    Same same = signs                                      ? relation.signs
                : by_map                                   ? relation.map
                : method.arithmetic == Arithmetic::doubles ? relation.doubles
                                                           : relation.floats;
    if (!exact && (same == bits || same == sides)) same = by_map ? map : rounded;
    // With brackets, signs are the same; the last bits of areas and where round lights' polygons have their corners are
    // not.
    const bool brackets = method.area_lights == AreaLights::brackets;
    const bool rounds   = same == sides || same == rounded || (brackets && !relation.name.starts_with("scaled by 2"));
    if (is_area(kind) && !centre && same != nothing && same != away && rounds)
        return brackets ? Same::brackets : method.area_lights == AreaLights::pattern ? Same::pattern : Same::samples;
    return same;
}

// ---- asking --------------------------------------------------------------------------------------------------------

struct Answers {
    VisibilityPlane plane;
    [[nodiscard]] float width(std::size_t i) const { return plane.half_width[i]; }
};

/// A method, built for a scene, where it serves it.
class AskedMethod {
public:
    AskedMethod(const std::string& choice, const Question& asked, const SceneFacts& facts)
        : asked_(&asked), method_(choice), serves_(method_.serves(facts)) {
        if (serves_) method_.build(asked.scene, facts);
    }
    [[nodiscard]] bool serves() const { return serves_; }
    void aim(LightId j) { method_.aim(j); }
    [[nodiscard]] Answers ask(const PointBatch& points, LightId j) const { return {method_.visibility(points, j)}; }
    [[nodiscard]] std::vector<Answers> all() {
        std::vector<Answers> answers;
        for (LightId j = 0; serves_ && j < asked_->scene.lights.size(); ++j) {
            aim(j);
            answers.push_back(ask(asked_->points, j));
        }
        return answers;
    }

private:
    const Question* asked_;
    Asked method_;
    bool serves_;
};

/// A scene with the answers of all methods, each found when first asked for.
class Answered {
public:
    explicit Answered(Question asked) : asked_(std::move(asked)), facts_(find_facts(asked_.scene)) {}

    [[nodiscard]] const Question& asked() const { return asked_; }
    [[nodiscard]] const SceneFacts& facts() const { return facts_; }
    /// Empty where the method does not serve the scene.
    [[nodiscard]] const std::vector<Answers>& by(const std::string& choice) {
        const auto [found, fresh] = answers_.try_emplace(choice);
        if (fresh) found->second = AskedMethod(choice, asked_, facts_).all();
        return found->second;
    }
    [[nodiscard]] bool serves_exactly(const std::string& choice) const {
        return Asked(choice).serves(facts_).how == How::exactly;
    }
    /// Does the segment to the light (to an area light's centre) touch an edge or a vertex, and nothing more?
    [[nodiscard]] bool touches(LightId j, std::size_t i) {
        if (touching_.empty()) {
            const Question hard = with_point_lights(asked_);
            touching_           = AskedMethod("exact", hard, find_facts(hard.scene)).all();
        }
        return touching_[j].plane.answer[i] == Answer::on_boundary;
    }

private:
    Question asked_;
    SceneFacts facts_;
    std::map<std::string, std::vector<Answers>> answers_;
    std::vector<Answers> touching_;
};

// ---- holding one against the other ---------------------------------------------------------------------------------

struct Difference {
    std::size_t points = 0, other_side = 0;
    std::size_t touching  = 0;             ///< changed, and on a boundary
    std::size_t uncovered = 0;             ///< defined before or after, not both
    std::size_t changed = 0, outside = 0;  ///< in any bit; of these outside the edge bands, or the brackets
    std::size_t partial = 0;               ///< penumbra, before or after
    double largest = 0, sum = 0, squares = 0;
    std::string first;  ///< that changed, rather one outside

    [[nodiscard]] double share() const { return points > 0 ? double(changed) / double(points) : 0; }
    [[nodiscard]] double z() const {
        const auto n          = static_cast<double>(std::max<std::size_t>(points, 1));
        const double variance = squares - sum * sum / n;
        return variance > 0 ? std::abs(sum) / std::sqrt(variance) : 0;
    }
    [[nodiscard]] double rms() const { return partial > 0 ? std::sqrt(squares / double(partial)) : 0; }
};

/// The edge bands of the answers before and after, at indices before the change.
std::vector<std::uint8_t> bands(Answered& before, Answered& after, const Changed& changed, LightId j,
                                const std::string& choice, Same same) {
    const float tolerance          = visibility_tolerance(before.asked().scene.lights[j].kind);
    std::vector<std::uint8_t> band = edge_band(before.asked().points, j, before.by(choice)[j].plane, tolerance);
    if (same != Same::map) return band;
    const LightId light = changed.lights[j][0].light;
    const auto other    = edge_band(after.asked().points, light, after.by(choice)[light].plane, tolerance);
    for (std::size_t i = 0; i < band.size(); ++i) band[i] |= other[changed.point[i]];
    return band;
}

Difference difference(Answered& before, Answered& after, const Changed& changed, LightId j, const std::string& choice,
                      Same same) {
    const PointBatch &points = before.asked().points, &later = after.asked().points;
    const Answers& old       = before.by(choice)[j];
    const auto& now          = after.by(choice);
    const auto band          = bands(before, after, changed, j, choice, same);
    const bool size_of_light = is_area(after.asked().scene.lights[changed.lights[j][0].light].kind) !=
                               is_area(before.asked().scene.lights[j].kind);
    const bool may_touch = same == sides || same == rounded || same == map || same == Same::away_from_edges;
    Difference d;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t k = changed.point[i];
        bool open = is_open(points, j, i), same_side = true, same_defined = true, undefined = false;
        double s = 0, width = static_cast<double>(old.width(i));
        for (const Changed::Part& part : changed.lights[j]) {
            open |= is_open(later, part.light, k);
            same_side &= later.facing[part.light][k] == points.facing[j][i];
            const Answer answer = now[part.light].plane.answer[k];
            same_defined &= answer == old.plane.answer[i];
            undefined |= answer == Answer::undefined;
            s += static_cast<double>(part.weight) * static_cast<double>(now[part.light].plane.s[k]);
            width += static_cast<double>(part.weight) * static_cast<double>(now[part.light].width(k));
        }
        if (!open) continue;
        // A light in the plane of the point's triangle is behind it; a rounded one may be before it.
        const bool whole = changed.lights[j].size() == 1 && !size_of_light;
        d.other_side += whole && !same_side;
        if (whole && !same_side && !changed.exact) continue;
        if (same == Same::away_from_edges && !same_side) continue;  // almost in the plane
        ++d.points;
        if (old.plane.answer[i] == Answer::undefined && undefined) continue;
        if (!same_defined && (old.plane.answer[i] == Answer::undefined || undefined) && same != bits) {
            ++d.uncovered;
            continue;
        }
        const double by = s - static_cast<double>(old.plane.s[i]);
        if ((by != 0 || !same_defined) && may_touch) {
            bool touches = before.touches(j, i);
            for (const Changed::Part& part : changed.lights[j]) touches |= after.touches(part.light, k);
            if (touches) {
                ++d.touching;
                continue;
            }
        }
        d.partial += (s > 0 && s < 1) || (old.plane.s[i] > 0 && old.plane.s[i] < 1);
        d.sum += by;
        d.squares += by * by;
        d.largest = std::max(d.largest, std::abs(by));
        if (by == 0 && same_defined) continue;
        ++d.changed;
        const bool outside =
            same == Same::brackets ? std::abs(by) > width + (changed.exact ? 0x1p-20 : 0x1p-10) : !band[i];
        d.outside += outside;
        if (d.first.empty() || (outside && d.outside == 1)) {
            const dvec3 p   = place(before.asked().scene, points, i);
            const auto wide = static_cast<std::size_t>(points.raster->width);
            d.first = fmt::format("pixel {} {} at ({:.7g}, {:.7g}, {:.7g}), triangle {}: S {} -> {}{}", i % wide,
                                  i / wide, p.x, p.y, p.z, points.triangle[i], old.plane.s[i], s,
                                  same_defined ? "" : ", defined or not");
        }
    }
    return d;
}

/// What is wrong with a difference; empty where nothing is. `proven`: the method says that it serves the scene exactly.
std::string fault(const Difference& d, Same same, bool exact, bool proven) {
    const auto n = static_cast<double>(d.points);
    if (exact && d.other_side > 0) return fmt::format("{} points face the light otherwise", d.other_side);
    if (double(d.uncovered) > kCoverageShare * n + 2)
        return fmt::format("{} of {} points are covered before or after only", d.uncovered, d.points);
    switch (same) {
        case Same::bits:
        case Same::sides:
            if (d.changed > 0) return fmt::format("{} of {} points changed: {}", d.changed, d.points, d.first);
            break;
        case Same::rounded:
            if (double(d.changed) > kRoundedShare * n + 2 || (proven && d.outside > 0))
                return fmt::format("{} of {} points changed, {} of them outside the edge band: {}", d.changed, d.points,
                                   d.outside, d.first);
            break;
        case Same::brackets:
        case Same::away_from_edges:
            if (d.outside > 0)
                return fmt::format("{} of {} points changed outside the bounds: {}", d.outside, d.points, d.first);
            break;
        case Same::map:
            if (double(d.outside) > kMapOutside * n + 2 || double(d.changed) > kMapShare * n + 2)
                return fmt::format("{} of {} points changed, {} of them outside the edge band: {}", d.changed, d.points,
                                   d.outside, d.first);
            break;
        case Same::samples:
            if (d.partial >= 50 && d.z() > kZ)
                return fmt::format("the mean moved by {:.3g}, which is {:.1f} standard errors", d.sum / n, d.z());
            if (d.partial >= 50 && d.rms() > 0.18)
                return fmt::format("the noise is {:.3g} in {} points: {}", d.rms(), d.partial, d.first);
            break;
        case Same::pattern:
            if (d.largest > 0.5 || d.rms() > 0.15 || std::abs(d.sum) > double(d.partial) / 20 + 2)
                return fmt::format(
                    "changed by up to {:.3g}, rms {:.3g}, on average {:.3g} in {} points of penumbra: {}", d.largest,
                    d.rms(), d.sum / double(std::max<std::size_t>(d.partial, 1)), d.partial, d.first);
            break;
        case Same::nothing: break;
    }
    return {};
}

// ---- the scenes ----------------------------------------------------------------------------------------------------

struct Source {
    std::string name;
    std::string from;  ///< a known scene's name, or a file
    bool is_file = true;

    [[nodiscard]] Scene scene() const { return is_file ? load_scene(from) : known_scene(from).scene; }
};

void PrintTo(const Source& source, std::ostream* out) { *out << source.from; }

const char* named_files() { return std::getenv("UMBRA_METAMORPHIC_SCENES"); }

std::vector<Source> sources() {
    using std::filesystem::path;
    std::vector<Source> all;
    std::vector<path> files;
    if (named_files()) {
        std::istringstream words(named_files());
        for (std::string file; words >> file;) files.emplace_back(file);
    } else {
        for (const NamedScene& known : known_scenes())
            all.push_back({std::string(known.name), std::string(known.name), false});
        for (const auto& entry : std::filesystem::directory_iterator(UMBRA_SCENES))
            if (entry.path().extension() == ".json" && !entry.path().stem().string().starts_with("real_"))
                files.push_back(entry.path());
        std::sort(files.begin(), files.end());
    }
    for (const path& file : files) {
        std::string name = file.filename().string();
        std::replace_if(
            name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
        all.push_back({name, file.string(), true});
    }
    return all;
}

/// As typed, of each kind of method.
std::string choice_of(const Kind& kind) {
    return kind.settings.empty() ? std::string(kind.method) : fmt::format("{}:{}", kind.method, kind.settings);
}

struct Finding {
    std::size_t planes = 0, points = 0, touching = 0, uncovered = 0, changed = 0, outside = 0, faults = 0;
    double share = 0, largest = 0, z = 0;
    std::string worst;
};

/// By relation and method, printed at the end of a run over named files.
class Findings : public testing::Environment {
public:
    void add(std::string_view relation, const std::string& choice, const std::string& scene, const Difference& d,
             bool is_fault) {
        Finding& f = found_[{std::string(relation), choice}];
        ++f.planes;
        f.points += d.points, f.touching += d.touching, f.uncovered += d.uncovered, f.changed += d.changed,
            f.outside += d.outside;
        f.faults += is_fault;
        f.largest = std::max(f.largest, d.largest);
        f.z       = std::max(f.z, d.z());
        if (d.share() > f.share) f.share = d.share(), f.worst = scene;
    }
    void TearDown() override {
        if (!named_files()) return;
        fmt::print("{:18} {:36} {:>6} {:>9} {:>8} {:>9} {:>7} {:>7} {:>6}  {}\n", "relation", "method", "planes",
                   "points", "touching", "uncovered", "changed", "outside", "faults", "largest share, in");
        for (const auto& [key, f] : found_)
            fmt::print("{:18} {:36} {:6} {:9} {:8} {:9} {:7} {:7} {:6}  {:.2g} {}\n", key.first, key.second, f.planes,
                       f.points, f.touching, f.uncovered, f.changed, f.outside, f.faults, f.share, f.worst);
    }

private:
    std::map<std::pair<std::string, std::string>, Finding> found_;
};
Findings& findings() {
    static auto* const all = static_cast<Findings*>(testing::AddGlobalTestEnvironment(new Findings));
    return *all;
}

class Metamorphic : public testing::TestWithParam<Source> {
protected:
    /// Small pictures where CI waits for them: what a wrong sign or weight does shows in most of a shadow's points.
    static Question asked() {
        const int width = named_files() ? 96 : GetParam().is_file ? 48 : 64;
        return dyadic(GetParam().scene(), width, width * 9 / 16);
    }
};

TEST_P(Metamorphic, RelationsHold) {
    std::map<Question (*)(const Question&), Answered> bases;
    const auto plain = bases.try_emplace(nullptr, asked()).first;
    for (const Relation& relation : kRelations) {
        auto base = bases.find(relation.base);
        if (base == bases.end()) base = bases.try_emplace(relation.base, relation.base(plain->second.asked())).first;
        Answered& before = base->second;
        Changed changed  = relation.change(before.asked());
        Answered after(std::move(changed.after));
        for (const Kind& method : kKinds) {
            const std::string choice = choice_of(method);
            if (before.by(choice).empty() || after.by(choice).empty()) continue;
            for (LightId j = 0; j < before.asked().scene.lights.size(); ++j) {
                const LightKind kind = before.asked().scene.lights[j].kind;
                const Same same      = must_be(relation, method, kind, changed.exact);
                if (same == nothing) continue;
                const Difference d      = difference(before, after, changed, j, choice, same);
                const std::string wrong = fault(d, same, changed.exact, before.serves_exactly(choice));
                findings().add(relation.name, choice, GetParam().name, d, !wrong.empty());
                EXPECT_EQ(wrong, "") << choice << ", " << relation.name << ", light "
                                     << before.asked().scene.lights[j].name;
            }
        }
    }
}

// What a thread works on does not depend on the others.
TEST_P(Metamorphic, SameBitsForAnyNumberOfThreads) {
    const Answered scene(asked());
    for (const Kind& method : kKinds) {
        const std::string choice = choice_of(method);
        std::vector<std::vector<Answers>> answers;
        for (const int threads : {1, 3}) {
            const ThreadLimit limit(threads);
            answers.push_back(AskedMethod(choice, scene.asked(), scene.facts()).all());
        }
        for (std::size_t j = 0; j < answers[0].size(); ++j) {
            EXPECT_EQ(answers[0][j].plane.s, answers[1][j].plane.s) << choice;
            EXPECT_EQ(answers[0][j].plane.answer, answers[1][j].plane.answer) << choice;
        }
    }
}

// A point's answer does not depend on the others of its batch, nor on the raster: bit for bit, except for methods that
// look at the points from a position that depends on all of them and so round otherwise (Batch::rounds): for those,
// where nothing touches. (Samples are numbered by the point's index in the batch, which is kept.)
TEST_P(Metamorphic, SameAnswerAloneAndTogether) {
    Answered scene(asked());
    const PointBatch& points = scene.asked().points;
    std::vector<std::vector<std::uint8_t>> chosen;  // every fifth point, and some alone
    chosen.emplace_back(points.size());
    for (std::size_t i = 0; i < points.size(); i += 5) chosen[0][i] = 1;
    for (std::size_t i = points.size() / 7; i < points.size() && chosen.size() < 12; i += points.size() / 17) {
        chosen.emplace_back(points.size());
        chosen.back()[i] = 1;
    }
    for (const Kind& method : kKinds) {
        const std::string choice = choice_of(method);
        AskedMethod run(choice, scene.asked(), scene.facts());
        if (!run.serves()) continue;
        for (LightId j = 0; j < scene.asked().scene.lights.size(); ++j) {
            run.aim(j);
            const VisibilityPlane all = run.ask(points, j).plane;
            for (const auto& keep : chosen) {
                const Question some         = asked_for_some(scene.asked(), keep, false);
                const VisibilityPlane alone = run.ask(some.points, j).plane;
                for (std::size_t i = 0; i < keep.size(); ++i) {
                    if (!keep[i] || (method.batch == Batch::rounds && scene.touches(j, i))) continue;
                    EXPECT_EQ(alone.s[i], all.s[i]) << choice << ", point " << i;
                    EXPECT_EQ(alone.answer[i], all.answer[i]) << choice << ", point " << i;
                }
            }
        }
    }
}

TEST(MetamorphicKinds, AreOfMethodsInTheList) {
    for (const Kind& kind : kKinds) EXPECT_NO_THROW((void)parse_method(choice_of(kind))) << kind.method;
    for (const MethodInfo* info : methods())
        if (std::ranges::none_of(kKinds, [&](const Kind& kind) { return kind.method == info->name; }))
            fmt::print("{} has no line in shadows/metamorphic.def and is left out of this test\n", info->name);
}

INSTANTIATE_TEST_SUITE_P(All, Metamorphic, testing::ValuesIn(sources()), [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace umbra
