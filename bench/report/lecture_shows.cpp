#include "umbra/bench/report/lecture_shows.h"

#include <algorithm>
#include <charconv>

#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

constexpr Translated kNoName{};
constexpr Translated kConstant{"constant", "konstant", "σταθερή"};
constexpr Translated kFlat{"flat", "flach", "επίπεδη"};
constexpr Translated kGouraud{"Gouraud", "Gouraud", "Gouraud"};
constexpr Translated kPhong{"Phong", "Phong", "Phong"};
constexpr Translated kQuadratic{"quadratic", "quadratisch", "τετραγωνική"};
constexpr Translated kEverySecond{"every second pixel", "jeder zweite Bildpunkt", "κάθε δεύτερο εικονοστοιχείο"};
constexpr Translated kHighlightTest{"highlight test", "Glanzlichttest", "έλεγχος κηλίδας"};
constexpr Translated kTaylor{"Taylor polynomial", "Taylor-Polynom", "πολυώνυμο Taylor"};
constexpr Translated kDifferences{"forward differences", "Vorwärtsdifferenzen", "πρόσθιες διαφορές"};
constexpr Translated kExact{"exact", "exakt", "ακριβής"};
constexpr Translated kTriangles{"triangles", "Dreiecke", "τρίγωνα"};
constexpr Translated kFormula{"by formula", "per Formel", "με τύπο"};
constexpr Translated kWhole{"the whole", "das Ganze", "το σύνολο"};

constexpr Translated kRmse{"Difference from Phong shading (RMSE)", "Abstand von der Phong-Schattierung (RMSE)",
                           "Διαφορά από τη φωτοσκίαση Phong (RMSE)"};
constexpr Translated kKinks{"Strength of Mach bands over that of Phong shading",
                            "Stärke der Machbänder, geteilt durch die der Phong-Schattierung",
                            "Ένταση των ζωνών Mach ως προς τη φωτοσκίαση Phong"};
constexpr Translated kHighlight{"Brightest value over that of Phong shading",
                                "Hellster Wert, geteilt durch den der Phong-Schattierung",
                                "Λαμπρότερη τιμή ως προς τη φωτοσκίαση Phong"};
constexpr Translated kSums{"Evaluations of the sum", "Auswertungen der Summe", "Υπολογισμοί του αθροίσματος"};
constexpr Translated kRays{"Rays", "Strahlen", "Ακτίνες"};

LectureShow method_show(std::string_view id, std::string_view path, Translated name) {
    return {id, "", {{name, path}, {kExact, "reference.files.png"}}, {}, true};
}

const std::vector<LectureShow>& shows() {
    static const std::vector<LectureShow> all{
        {"C1",
         "shading",
         {{kConstant, "models.constant.picture"},
          {kFlat, "models.flat.picture"},
          {kGouraud, "models.gouraud.picture"},
          {kPhong, "models.phong.picture"}},
         {{kRmse,
           FigureKind::score,
           {{kConstant, "models.constant.rmse"}, {kFlat, "models.flat.rmse"}, {kGouraud, "models.gouraud.rmse"}}}}},
        {"C2",
         "shading",
         {{kFlat, "models.flat.picture"}, {kPhong, "models.phong.picture"}},
         {{kKinks, FigureKind::score, {{kFlat, "models.flat.kink"}}}}},
        {"C3",
         "shading",
         {{kPhong, "models.phong.picture"},
          {kQuadratic, "models.quadratic.picture"},
          {{"difference", "Differenz", "διαφορά"}, "models.quadratic.difference"}},
         {{kRmse, FigureKind::score, {{kQuadratic, "models.quadratic.rmse"}}}}},
        {"C4",
         "shading",
         {{kEverySecond, "models.every_second.picture"},
          {{"difference", "Differenz", "διαφορά"}, "models.every_second.difference"}},
         {{kSums,
           FigureKind::count,
           {{kEverySecond, "models.every_second.evaluations"}, {kPhong, "models.phong.evaluations"}}},
          {kRmse, FigureKind::score, {{kEverySecond, "models.every_second.rmse"}}}}},
        {"C5",
         "shading",
         {{kGouraud, "models.gouraud.picture"},
          {kPhong, "models.phong.picture"},
          {{"difference", "Differenz", "διαφορά"}, "models.gouraud.difference"}},
         {{kHighlight, FigureKind::score, {{kGouraud, "models.gouraud.highlight"}}},
          {kKinks, FigureKind::score, {{kFlat, "models.flat.kink"}, {kGouraud, "models.gouraud.kink"}}}}},
        {"C6",
         "whitted",
         {{{"blended", "gemischt", "ανάμειξη"}, "picture"},
          {{"screen door", "Fliegengitter", "πλέγμα σήτας"}, "screen_door.picture"}},
         {{{"Screen door, difference from the blended picture (RMSE)",
            "Fliegengitter, Abstand vom gemischten Bild (RMSE)", "Πλέγμα σήτας, διαφορά από την ανάμειξη (RMSE)"},
           FigureKind::score,
           {{kNoName, "screen_door.rmse"}}}}},
        {"C8",
         "shading",
         {{kFlat, "models.flat.picture"}, {kPhong, "models.phong.picture"}},
         {{kRmse, FigureKind::score, {{kFlat, "models.flat.rmse"}, {kGouraud, "models.gouraud.rmse"}}}},
         false},
        {"C10",
         "shading",
         {{kGouraud, "models.gouraud.picture"}, {kPhong, "models.phong.picture"}},
         {{kRmse, FigureKind::score, {{kGouraud, "models.gouraud.rmse"}}}}},
        {"C11",
         "shading",
         {{kHighlightTest, "models.highlight_test.picture"},
          {kTaylor, "models.taylor.picture"},
          {kDifferences, "models.differences.picture"},
          {kPhong, "models.phong.picture"}},
         {{kSums,
           FigureKind::count,
           {{kHighlightTest, "models.highlight_test.evaluations"},
            {kTaylor, "models.taylor.evaluations"},
            {kDifferences, "models.differences.evaluations"},
            {kPhong, "models.phong.evaluations"}}},
          {kRmse,
           FigureKind::score,
           {{kHighlightTest, "models.highlight_test.rmse"},
            {kTaylor, "models.taylor.rmse"},
            {kDifferences, "models.differences.rmse"}}}}},
        {"C12",
         "shading",
         {{{"wireframe", "Drahtgitter", "συρματόπλεγμα"}, "stages.wireframe.picture"},
          {{"hidden lines", "verdeckte Linien", "κρυμμένες γραμμές"}, "stages.hidden_lines.picture"},
          {{"ambient term", "ambienter Term", "όρος περιβάλλοντος"}, "stages.ambient.picture"},
          {kFlat, "stages.flat.picture"},
          {{"Gouraud, diffuse", "Gouraud, diffus", "Gouraud, διάχυτος"}, "stages.gouraud_diffuse.picture"},
          {kGouraud, "stages.gouraud.picture"},
          {kPhong, "stages.phong.picture"},
          {{"shadows", "Schatten", "σκιές"}, "stages.shadows.picture"},
          {{"recursive rays", "rekursive Strahlen", "αναδρομικές ακτίνες"}, "stages.whitted.picture"}},
         {}},
        method_show("D1", "methods.planar_projection.files.png",
                    {"planar projection", "Projektion auf Ebenen", "προβολή σε επίπεδα"}),
        method_show("D2", "methods.scan_line.files.png", {"scan line", "Scanline", "γραμμή σάρωσης"}),
        method_show("D3", "methods.shadow_volumes.files.png", {"shadow volumes", "Schattenvolumen", "όγκοι σκιάς"}),
        method_show("D4", "methods.atherton_weiler.files.png",
                    {"lit polygons", "beleuchtete Polygone", "φωτισμένα πολύγωνα"}),
        method_show("D5", "methods.shadow_zbuffer.files.png",
                    {"shadow z-buffer", "Schatten-z-Puffer", "z-buffer σκιάς"}),
        method_show("D6", "methods.ray_traced.files.png", {"shadow rays", "Schattenstrahlen", "ακτίνες σκιάς"}),
        {"D7",
         "radiosity",
         {{{"light of the lamp", "Licht der Lampe", "φως της λάμπας"}, "pictures.0"},
          {{"light of surfaces", "Licht der Flächen", "φως των επιφανειών"}, "pictures.1"},
          {{"both", "beides", "και τα δύο"}, "pictures.2"},
          {{"patches", "Flächenstücke", "τμήματα"}, "pictures.3"},
          {{"form factors", "Formfaktoren", "συντελεστές μορφής"}, "pictures.4"}},
         {{{"Patches", "Flächenstücke", "Τμήματα"}, FigureKind::count, {{kNoName, "patches"}}},
          {{"Steps", "Schritte", "Βήματα"}, FigureKind::count, {{kNoName, "steps"}}}}},
        {"B13",
         "whitted",
         {{{"no mirrored rays", "ohne gespiegelte Strahlen", "χωρίς ανακλώμενες ακτίνες"}, "depths.0.picture"},
          {kWhole, "picture"}},
         {{kRays,
           FigureKind::count,
           {{{"reflected", "gespiegelt", "ανακλώμενες"}, "formula.totals_of_triangles.reflected"},
            {{"refracted", "gebrochen", "διαθλώμενες"}, "formula.totals_of_triangles.refracted"}}}}},
        {"E1",
         "whitted",
         {{{"depth 1", "Tiefe 1", "βάθος 1"}, "depths.0.picture"},
          {{"depth 2", "Tiefe 2", "βάθος 2"}, "depths.1.picture"},
          {{"depth 3", "Tiefe 3", "βάθος 3"}, "depths.2.picture"},
          {{"depth 4", "Tiefe 4", "βάθος 4"}, "depths.3.picture"},
          {{"depth 5", "Tiefe 5", "βάθος 5"}, "depths.4.picture"}},
         {{{"Difference from depth 5 (RMSE)", "Abstand von Tiefe 5 (RMSE)", "Διαφορά από το βάθος 5 (RMSE)"},
           FigureKind::score,
           {{{"depth 1", "Tiefe 1", "βάθος 1"}, "depths.0.rmse"},
            {{"2", "2", "2"}, "depths.1.rmse"},
            {{"3", "3", "3"}, "depths.2.rmse"},
            {{"4", "4", "4"}, "depths.3.rmse"}}}}},
        {"E2",
         "whitted",
         {{kTriangles, "picture"}, {kFormula, "formula.picture"}},
         {{{"Bodies by formula", "Körper per Formel", "Σώματα με τύπο"},
           FigureKind::count,
           {{{"spheres", "Kugeln", "σφαίρες"}, "formula.bodies.spheres"},
            {{"boxes", "Quader", "κουτιά"}, "formula.bodies.boxes"}}},
          {{"Triangles that they replace", "Dreiecke, die sie ersetzen", "Τρίγωνα που αντικαθιστούν"},
           FigureKind::count,
           {{kNoName, "formula.triangles_replaced"}}},
          {{"Difference of the pictures (RMSE)", "Abstand der Bilder (RMSE)", "Διαφορά των εικόνων (RMSE)"},
           FigureKind::score,
           {{kNoName, "formula.rmse"}}}}},
        {"E3",
         "whitted",
         {{{"one ray a pixel", "ein Strahl je Bildpunkt", "μία ακτίνα ανά εικονοστοιχείο"}, "single.picture"},
          {{"four rays a pixel", "vier Strahlen je Bildpunkt", "τέσσερις ακτίνες ανά εικονοστοιχείο"}, "picture"}},
         {{{"Difference of the two (RMSE)", "Abstand der beiden (RMSE)", "Διαφορά των δύο (RMSE)"},
           FigureKind::score,
           {{kNoName, "single.rmse"}}}}},
        {"E4",
         "whitted",
         {{{"rays a pixel", "Strahlen je Bildpunkt", "ακτίνες ανά εικονοστοιχείο"}, "rays_picture"}},
         {{{"Share of the time, per cent", "Anteil an der Zeit in Prozent", "Μερίδιο του χρόνου, τοις εκατό"},
           FigureKind::percent,
           {{{"eye rays", "Augstrahlen", "ακτίνες από το μάτι"}, "phases.eye_rays.fraction"},
            {{"secondary rays", "Sekundärstrahlen", "δευτερεύουσες ακτίνες"}, "phases.secondary_rays.fraction"},
            {{"shadows", "Schatten", "σκιές"}, "phases.shadows.fraction"},
            {{"sums", "Summen", "αθροίσματα"}, "phases.sums.fraction"},
            {{"directions", "Richtungen", "κατευθύνσεις"}, "phases.directions.fraction"},
            {{"gathering", "Sammeln", "συλλογή"}, "phases.gathering.fraction"}}}}},
        {"E5",
         "whitted",
         {{kNoName, "picture"}},
         {{{"Microseconds a ray", "Mikrosekunden je Strahl", "Μικροδευτερόλεπτα ανά ακτίνα"},
           FigureKind::score,
           {{{"tree", "Baum", "δέντρο"}, "search.tree_us"},
            {{"all triangles", "alle Dreiecke", "όλα τα τρίγωνα"}, "search.search_us"}}},
          {{"Rays that met something else", "Strahlen, die anderes trafen", "Ακτίνες που συνάντησαν κάτι άλλο"},
           FigureKind::count,
           {{kNoName, "search.different"}}}}},
        {"E6",
         "whitted",
         {{kNoName, "picture"},
          {{"orange: a mirror sends light here, S_j is 0", "orange: ein Spiegel schickt Licht hierher, S_j ist 0",
            "πορτοκαλί: ένας καθρέφτης στέλνει φως εδώ, S_j = 0"},
           "blind.picture"}},
         {{{"Pixels that a mirror lights", "Bildpunkte, die ein Spiegel beleuchtet",
            "Εικονοστοιχεία που φωτίζει καθρέφτης"},
           FigureKind::count,
           {{{"all", "alle", "όλα"}, "blind.points"},
            {{"in shadow", "im Schatten", "σε σκιά"}, "blind.points_in_shadow"}}}}},
        {"E7",
         "whitted",
         {{{"rays a pixel", "Strahlen je Bildpunkt", "ακτίνες ανά εικονοστοιχείο"}, "rays_picture"}},
         {{kRays,
           FigureKind::count,
           {{{"where surfaces mirror", "wo Flächen spiegeln", "όπου υπάρχει ανάκλαση"}, "ways.raster.rays"},
            {{"everywhere", "überall", "παντού"}, "ways.everywhere.rays"}}},
          {{"Pixels that differ", "Bildpunkte, die sich unterscheiden", "Εικονοστοιχεία που διαφέρουν"},
           FigureKind::count,
           {{kNoName, "ways.everywhere.different_pixels"}}}}},
    };
    return all;
}

Field entry(const Field& array, std::string_view name) {
    const std::vector<Field> items = array.items();
    std::size_t number             = 0;
    const auto end                 = name.data() + name.size();
    if (const auto read = std::from_chars(name.data(), end, number); read.ec == std::errc{} && read.ptr == end)
        return number < items.size() ? items[number] : Field{};
    const auto found = std::ranges::find_if(items, [&](const Field& item) { return item["name"].text() == name; });
    return found == items.end() ? Field{} : *found;
}

std::string figure_of(const Field& value, FigureKind kind) {
    switch (kind) {
        case FigureKind::count: return count(value.number());
        case FigureKind::percent: return percent(value.number());
        case FigureKind::score: break;
    }
    return score(value.number());
}

std::string value_in_words(const Field& value, FigureKind kind, Language language) {
    const std::string figure = figure_of(value, kind);
    return language == Language::english ? figure : with_decimal_comma(figure);
}

}  // namespace

const LectureShow* lecture_show(std::string_view id) {
    const auto found = std::ranges::find(shows(), id, &LectureShow::id);
    return found == shows().end() ? nullptr : &*found;
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

std::string figure_in_words(const LectureFigure& figure, const Field& root, Language language) {
    std::string words;
    for (const LectureValue& value : figure.values) {
        const Field there = value_at(root, value.path);
        if (!there.present()) continue;
        words += words.empty() ? ": " : ", ";
        if (const std::string_view name = value.name.in(language); !name.empty()) words += std::string(name) + " ";
        words += value_in_words(there, figure.kind, language);
    }
    return words.empty() ? "" : std::string(figure.what.in(language)) + words + ".";
}

}  // namespace umbra
