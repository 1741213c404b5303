#include "umbra/bench/report/lecture_texts.h"

#include <array>
#include <utility>

namespace umbra {
namespace {

constexpr std::array<std::pair<std::string_view, Language>, 3> kLanguages{
    {{"en", Language::english}, {"de", Language::german}, {"el", Language::greek}}};

constexpr Translated kSixLights{
    "Six lights shine on one scene, and their terms add up: each has a shadow of its own, which the others fill.",
    "Sechs Lichtquellen beleuchten eine Szene, und ihre Terme addieren sich: Jede wirft ihren eigenen Schatten, den "
    "die anderen aufhellen.",
    "Έξι φωτεινές πηγές φωτίζουν μία σκηνή και οι όροι τους αθροίζονται: καθεμία ρίχνει τη δική της σκιά, την οποία "
    "φωτίζουν οι άλλες."};

constexpr std::array kTexts{
    LectureText{"A1",
                "Umgebungslicht, I_a k_a",
                "φως περιβάλλοντος, I_a k_a",
                {"Where no light reaches, the ambient term I_a k_a is what is left: no shadow is black.",
                 "Wohin keine Lichtquelle reicht, bleibt der ambiente Term I_a k_a: Kein Schatten ist schwarz.",
                 "Όπου δεν φτάνει καμία πηγή, απομένει ο όρος περιβάλλοντος I_a k_a: καμία σκιά δεν είναι μαύρη."}},
    LectureText{"A2",
                "Richtungslicht (Lichtquelle im Unendlichen)",
                "κατευθυντικό φως (πηγή στο άπειρο)",
                {"The rays of the sun are parallel, so that the shadow is a parallel projection.",
                 "Die Strahlen der Sonne sind parallel, der Schatten ist also eine Parallelprojektion.",
                 "Οι ακτίνες του ήλιου είναι παράλληλες, άρα η σκιά είναι παράλληλη προβολή."}},
    LectureText{
        "A3",
        "Punktlichtquelle, E = I cos(θ) / d²",
        "σημειακή πηγή, E = I cos(θ) / d²",
        {"A surface twice as far from the lamp, at the same angle, is a quarter as bright: E = I cos θ / d².",
         "Eine Fläche in doppeltem Abstand ist unter gleichem Winkel ein Viertel so hell: E = I cos θ / d².",
         "Σε διπλάσια απόσταση και ίδια γωνία μια επιφάνεια έχει το ένα τέταρτο της φωτεινότητας: E = I cos θ / d²."}},
    LectureText{"A4",
                "Spotlicht: Potenz des Kosinus, Öffnungswinkel",
                "προβολέας: δύναμη του συνημιτόνου, γωνία αποκοπής",
                {"A spot light fades with a power of the cosine, and ends at its cut-off angle.",
                 "Ein Spotlicht fällt mit einer Potenz des Kosinus ab und endet am Öffnungswinkel.",
                 "Ο προβολέας εξασθενεί με μια δύναμη του συνημιτόνου και τελειώνει στη γωνία αποκοπής."}},
    LectureText{"A5",
                "Spotlicht nach Zachmann",
                "προβολέας κατά Zachmann",
                {"The printed law is negative near the rim for n > 1; here it ends at 0.",
                 "Das gedruckte Gesetz wird für n > 1 nahe am Rand negativ; hier endet es bei 0.",
                 "Ο τυπωμένος νόμος γίνεται αρνητικός κοντά στο χείλος για n > 1· εδώ τελειώνει στο 0."}},
    LectureText{"A6",
                "goniometrische Lichtquelle aus IES-LM-63-Dateien",
                "γωνιομετρική πηγή από αρχεία IES LM-63",
                {"The lamp's table sends light along the road and none above the horizon; beside it the same lamp "
                 "sends it evenly.",
                 "Die Tabelle der Lampe schickt Licht die Straße entlang und keines über den Horizont; daneben "
                 "dieselbe Lampe, gleichmäßig.",
                 "Ο πίνακας της λάμπας στέλνει φως κατά μήκος του δρόμου και καθόλου πάνω από τον ορίζοντα· δίπλα η "
                 "ίδια λάμπα φωτίζει ομοιόμορφα."}},
    LectureText{"A7",
                "Rechteck, Kreisscheibe, Kugel; Halbschatten",
                "ορθογώνιο, δίσκος, σφαίρα· παρασκιά",
                {"The larger the light, the smaller the umbra and the wider the penumbra.",
                 "Je größer die Lichtquelle, desto kleiner der Kernschatten und desto breiter der Halbschatten.",
                 "Όσο μεγαλύτερη η πηγή, τόσο μικρότερη η κύρια σκιά και τόσο πλατύτερη η παρασκιά."}},
    LectureText{"A8", "getrennte ambiente, diffuse und spiegelnde Farben",
                "χωριστά χρώματα περιβάλλοντος, διάχυτα και κατοπτρικά", kSixLights},
    LectureText{"A9", "Abschwächung, auf 1 begrenzt oder nicht", "εξασθένιση, με ή χωρίς όριο 1", {}},
    LectureText{"A10",
                "bewegte Lichtquellen, Objekte und Kameras",
                "κινούμενες πηγές, αντικείμενα και κάμερες",
                {"The first of 13 frames: the sun is low, and shadows are long. Keys in the scene file move it; umbra "
                 "compare a_day@0..12 shows the whole day.",
                 "Das erste von 13 Bildern: Die Sonne steht tief, die Schatten sind lang. Schlüsselbilder in der "
                 "Szenendatei bewegen sie; umbra compare a_day@0..12 zeigt den ganzen Tag.",
                 "Το πρώτο από 13 καρέ: ο ήλιος είναι χαμηλά και οι σκιές μακριές. Καρέ-κλειδιά στο αρχείο της σκηνής "
                 "τον κινούν· η εντολή umbra compare a_day@0..12 δείχνει όλη την ημέρα."}},
    LectureText{"A11",
                "Lichtquellen an- und ausschalten; an der Kamera befestigt",
                "πηγές που ανάβουν και σβήνουν· στερεωμένες στην κάμερα",
                {"The only light is fixed to the camera: it goes where the eye goes, and is not seen.",
                 "Die einzige Lichtquelle ist an der Kamera befestigt: Sie geht mit dem Auge und ist nicht zu sehen.",
                 "Η μόνη πηγή είναι στερεωμένη στην κάμερα: κινείται με το μάτι και δεν φαίνεται."}},
    LectureText{"A12",
                "welche Lichtquelle es ist, am beleuchteten Teil einer Kugel",
                "ποια πηγή είναι, από το φωτισμένο μέρος μιας σφαίρας",
                {"A sun lights half of a ball, a lamp at the distance d from its middle only (1 - r / d) / 2.",
                 "Eine Sonne beleuchtet die halbe Kugel, eine Lampe im Abstand d vom Mittelpunkt nur (1 - r / d) / 2.",
                 "Ένας ήλιος φωτίζει τη μισή σφαίρα, μια λάμπα σε απόσταση d από το κέντρο μόνο (1 - r / d) / 2."}},
    LectureText{
        "A13",
        "Warnocks Regel: Die Intensität fällt mit der Tiefe",
        "κανόνας του Warnock: η ένταση πέφτει με το βάθος",
        {"Brightness falls with depth, as Warnock drew it in 1969: an attenuated light at the eye.",
         "Die Helligkeit fällt mit der Tiefe, wie Warnock sie 1969 zeichnete: eine abgeschwächte Lichtquelle am Auge.",
         "Η φωτεινότητα πέφτει με το βάθος, όπως τη σχεδίασε ο Warnock το 1969: μια πηγή στο μάτι με εξασθένιση."}},
    LectureText{"A14",
                "fotometrische Größen; die Bestrahlungsstärke fällt quadratisch",
                "φωτομετρικά μεγέθη· η πυκνότητα ροής πέφτει με το τετράγωνο",
                {}},

    LectureText{"B1",
                "Lamberts diffuser Term",
                "διάχυτος όρος του Lambert",
                {"The plane is equally bright everywhere, since N · L is the same at each of its points.",
                 "Die Ebene ist überall gleich hell, denn N · L ist in jedem ihrer Punkte gleich.",
                 "Το επίπεδο έχει παντού την ίδια φωτεινότητα, αφού το N · L είναι ίδιο σε κάθε σημείο του."}},
    LectureText{"B2",
                "Phongs spiegelnder Term",
                "κατοπτρικός όρος του Phong",
                {"Highlights lie where the mirrored light direction R meets the direction V to the eye.",
                 "Glanzlichter liegen dort, wo die gespiegelte Lichtrichtung R auf die Richtung V zum Auge fällt.",
                 "Οι στιλπνές κηλίδες βρίσκονται όπου η ανακλώμενη κατεύθυνση R συμπίπτει με την κατεύθυνση V προς τον "
                 "παρατηρητή."}},
    LectureText{"B3", "Blinn-Phong, und wie sich die Exponenten verhalten", "Blinn-Phong και η σχέση των εκθετών", {}},
    LectureText{"B4", "Emission", "εκπομπή", {}},
    LectureText{"B5",
                "Material je Farbkanal; Bilanz k_d + k_s + k_t",
                "υλικό ανά χρώμα· ισοζύγιο k_d + k_s + k_t",
                {"Coloured light on coloured surfaces: each channel is computed on its own.",
                 "Farbiges Licht auf farbigen Flächen: Jeder Farbkanal wird für sich berechnet.",
                 "Έγχρωμο φως σε έγχρωμες επιφάνειες: κάθε χρώμα υπολογίζεται χωριστά."}},
    LectureText{"B6", "Summe über die Lichtquellen", "άθροισμα πάνω στις πηγές", kSixLights},
    LectureText{"B7",
                "Werte über 1: abschneiden, teilen, Farbton behalten",
                "τιμές πάνω από 1: αποκοπή, διαίρεση, διατήρηση απόχρωσης",
                {}},
    LectureText{"B8",
                "ein- und zweiseitige Beleuchtung",
                "μονόπλευρος και αμφίπλευρος φωτισμός",
                {"Sheets without thickness are lit on the side that the eye sees, and throw shadows from both.",
                 "Flächen ohne Dicke sind auf der sichtbaren Seite beleuchtet und werfen von beiden Seiten Schatten.",
                 "Φύλλα χωρίς πάχος φωτίζονται στην πλευρά που φαίνεται και ρίχνουν σκιά και από τις δύο."}},
    LectureText{"B9", "Betrachter im Unendlichen und am Ort", "παρατηρητής στο άπειρο και τοπικός", {}},
    LectureText{
        "B10",
        "Lafortunes Keulen",
        "λοβοί του Lafortune",
        {"With the matrix diag(-1, -1, 1) the lobe is Phong's highlight; other matrices stretch and tilt it.",
         "Mit der Matrix diag(-1, -1, 1) ist die Keule Phongs Glanzlicht; andere Matrizen strecken und kippen sie.",
         "Με τον πίνακα diag(-1, -1, 1) ο λοβός είναι η κηλίδα του Phong· άλλοι πίνακες τον τεντώνουν και τον "
         "γέρνουν."}},
    LectureText{"B11",
                "Reziprozität, Energie, Isotropie durch Abtasten",
                "αμοιβαιότητα, ενέργεια, ισοτροπία με δειγματοληψία",
                {"Phong's specular term, as the sum has it, keeps neither reciprocity nor energy; Lafortune's lobes "
                 "keep reciprocity.",
                 "Phongs spiegelnder Term, wie er in der Summe steht, erhält weder Reziprozität noch Energie; "
                 "Lafortunes Keulen erhalten die Reziprozität.",
                 "Ο κατοπτρικός όρος του Phong, όπως είναι στο άθροισμα, δεν τηρεί ούτε αμοιβαιότητα ούτε ενέργεια· οι "
                 "λοβοί του Lafortune τηρούν την αμοιβαιότητα."}},
    LectureText{"B12", "spektral gegen RGB", "φασματικά και RGB", {}},
    LectureText{"B13",
                "Whitteds Summe mit k_r und k_t",
                "το άθροισμα του Whitted με k_r και k_t",
                {"Mirrors add k_r times what the mirrored ray sees, glass adds k_t times what the refracted one sees.",
                 "Spiegel fügen k_r mal das hinzu, was der gespiegelte Strahl sieht, Glas k_t mal das des gebrochenen.",
                 "Οι καθρέφτες προσθέτουν k_r επί ό,τι βλέπει η ανακλώμενη ακτίνα, το γυαλί k_t επί ό,τι βλέπει η "
                 "διαθλώμενη."}},
    LectureText{"B14", "Varianten der Summe", "παραλλαγές του αθροίσματος", {}},
    LectureText{"B15", "interpolierte Normalen ohne Normieren", "παρεμβολή κανονικών χωρίς κανονικοποίηση", {}},
    LectureText{"B16",
                "Normalen unter Transformationen: inverse Transponierte",
                "κανονικά διανύσματα και μετασχηματισμοί: αντίστροφος ανάστροφος",
                {"Under uneven scale normals follow the inverse transpose; scaled as points are, they would lean the "
                 "wrong way.",
                 "Bei ungleicher Skalierung folgen Normalen der inversen Transponierten; wie Punkte skaliert, kippten "
                 "sie falsch.",
                 "Σε ανομοιόμορφη κλιμάκωση οι κανονικές ακολουθούν τον αντίστροφο ανάστροφο· αν κλιμακώνονταν όπως τα "
                 "σημεία, θα έγερναν λάθος."}},
    LectureText{"B17", "Anpassung eines Lafortune-Modells", "προσαρμογή μοντέλου Lafortune", {}},
    LectureText{"B18",
                "die Bilder der Vorlesungen",
                "οι εικόνες των διαλέξεων",
                {"Ambient, diffuse and specular term are added pixel by pixel: the fourth column is the sum of the "
                 "first three, under light at 60, 25 and 0 degrees.",
                 "Ambienter, diffuser und spiegelnder Term addieren sich Bildpunkt für Bildpunkt: Die vierte Spalte "
                 "ist die Summe der ersten drei, bei Licht unter 60, 25 und 0 Grad.",
                 "Ο όρος περιβάλλοντος, ο διάχυτος και ο κατοπτρικός αθροίζονται εικονοστοιχείο προς εικονοστοιχείο: η "
                 "τέταρτη στήλη είναι το άθροισμα των τριών πρώτων, με φως στις 60, 25 και 0 μοίρες."}},

    LectureText{
        "C1",
        "konstante, flache, Gouraud- und Phong-Schattierung",
        "σταθερή, επίπεδη, Gouraud και Phong φωτοσκίαση",
        {"One value a triangle without lights; the sum once a face, at vertices, and at every pixel: shadows are "
         "as coarse as the shading, since S_j is asked where the sum is.",
         "Ein Wert je Dreieck ohne Lichtquellen; die Summe je Fläche, an den Ecken, an jedem Bildpunkt: Schatten "
         "sind so grob wie die Schattierung, denn S_j wird dort bestimmt, wo die Summe ausgewertet wird.",
         "Μία τιμή ανά τρίγωνο χωρίς πηγές· το άθροισμα ανά έδρα, στις κορυφές, σε κάθε εικονοστοιχείο: οι σκιές είναι "
         "τόσο χονδροειδείς όσο η φωτοσκίαση, αφού το S_j ζητείται όπου υπολογίζεται το άθροισμα."}},
    LectureText{"C2",
                "gemittelte Eckennormalen",
                "κανονικά κορυφών από μέσους όρους",
                {"The balls are made of flat triangles; normals averaged at the vertices make them look round.",
                 "Die Kugeln bestehen aus flachen Dreiecken; gemittelte Normalen an den Ecken lassen sie rund wirken.",
                 "Οι σφαίρες αποτελούνται από επίπεδα τρίγωνα· οι μέσες κανονικές στις κορυφές τις κάνουν να φαίνονται "
                 "στρογγυλές."}},
    LectureText{
        "C3",
        "quadratische Interpolation der Normalen",
        "τετραγωνική παρεμβολή κανονικών",
        {"Normals interpolated quadratically along edges follow waves that linear ones miss; on balls both are "
         "almost the same.",
         "Quadratisch interpolierte Normalen folgen Wellen, die linear interpolierte übersehen; auf Kugeln sind "
         "beide fast gleich.",
         "Οι τετραγωνικά παρεμβαλλόμενες κανονικές ακολουθούν κυματισμούς που χάνουν οι γραμμικές· σε σφαίρες "
         "είναι σχεδόν ίδιες."}},
    LectureText{
        "C4",
        "jeder zweite Bildpunkt",
        "κάθε δεύτερο εικονοστοιχείο",
        {"Half of the sums are replaced by the mean of their neighbours: only edges and shadow borders show it.",
         "Die Hälfte der Summen wird durch das Mittel der Nachbarn ersetzt: Nur Kanten und Schattenränder zeigen "
         "es.",
         "Τα μισά αθροίσματα αντικαθίστανται από τον μέσο όρο των γειτόνων: μόνο ακμές και όρια σκιών το "
         "δείχνουν."}},
    LectureText{
        "C5",
        "Fehler der Gouraud-Schattierung, gemessen",
        "σφάλματα της φωτοσκίασης Gouraud, μετρημένα",
        {"Where no vertex lies in a highlight, Gouraud shading misses it, and along edges its slope jumps: Mach "
         "bands.",
         "Wo keine Ecke im Glanzlicht liegt, verfehlt es die Gouraud-Schattierung, und an Kanten springt ihre "
         "Steigung: Machbänder.",
         "Όπου καμία κορυφή δεν βρίσκεται στη στιλπνή κηλίδα, η φωτοσκίαση Gouraud τη χάνει, και στις ακμές η "
         "κλίση της αλλάζει απότομα: ζώνες Mach."}},
    LectureText{
        "C6",
        "Transparenz",
        "διαφάνεια",
        {"Behind one sheet 60 or 30 per cent of the light arrive, behind both their product, 18 per cent: the "
         "transmittances multiply. A screen door leaves out eye rays instead of blending.",
         "Hinter einer Folie kommen 60 oder 30 Prozent des Lichts an, hinter beiden das Produkt, 18 Prozent: "
         "Die Durchlässigkeiten multiplizieren sich. Ein Fliegengitter lässt Augstrahlen aus, statt zu mischen.",
         "Πίσω από ένα φύλλο φτάνει το 60 ή το 30 τοις εκατό του φωτός, πίσω και από τα δύο το γινόμενό τους, "
         "18 τοις εκατό: οι διαπερατότητες πολλαπλασιάζονται. Το πλέγμα σήτας παραλείπει ακτίνες αντί να "
         "αναμειγνύει."}},
    LectureText{"C7",
                "Nebel",
                "ομίχλη",
                {"Fog weakens what is far, light and shadow alike; S_j is the same with and without it.",
                 "Nebel schwächt, was fern ist, Licht und Schatten gleichermaßen; S_j ist mit und ohne Nebel gleich.",
                 "Η ομίχλη εξασθενεί ό,τι είναι μακριά, φως και σκιά εξίσου· το S_j είναι ίδιο με ή χωρίς αυτήν."}},
    LectureText{
        "C8",
        "wo flache Schattierung richtig ist",
        "πού η επίπεδη φωτοσκίαση είναι σωστή",
        {"Sun and viewer are at infinity and the faces are the surface: flat shading equals Phong shading there.",
         "Sonne und Betrachter sind im Unendlichen, und die Flächen sind die Oberfläche: Flache und Phong-Schattierung "
         "sind gleich.",
         "Ο ήλιος και ο παρατηρητής είναι στο άπειρο και οι έδρες είναι η επιφάνεια: η επίπεδη φωτοσκίαση ισούται με "
         "του Phong."}},
    LectureText{"C9",
                "weitere Fehler der Interpolation",
                "άλλα σφάλματα της παρεμβολής",
                {"Interpolated normals round off a coarse ball inside; its outline and its shadow keep their corners.",
                 "Interpolierte Normalen runden eine grobe Kugel innen; Umriss und Schatten behalten ihre Ecken.",
                 "Οι παρεμβαλλόμενες κανονικές στρογγυλεύουν μια χονδροειδή σφαίρα εσωτερικά· το περίγραμμα και η σκιά "
                 "της κρατούν τις γωνίες τους."}},
    LectureText{"C10",
                "Einfluss der Triangulierung",
                "επίδραση της τριγωνοποίησης",
                {"The same square in 1, 2, 3, 5, 10 and 40 rows of faces: Gouraud shading finds the highlight only if "
                 "a vertex lies in it.",
                 "Dasselbe Quadrat in 1, 2, 3, 5, 10 und 40 Reihen von Flächen: Gouraud-Schattierung findet das "
                 "Glanzlicht nur, wenn eine Ecke darin liegt.",
                 "Το ίδιο τετράγωνο σε 1, 2, 3, 5, 10 και 40 σειρές εδρών: η φωτοσκίαση Gouraud βρίσκει τη στιλπνή "
                 "κηλίδα μόνο αν μια κορυφή βρίσκεται μέσα της."}},
    LectureText{
        "C11",
        "Schnelligkeit gegen Genauigkeit beim Schattieren",
        "ταχύτητα και ακρίβεια στη φωτοσκίαση",
        {"Three ways to Phong's picture with fewer sums: where a highlight may lie, by a polynomial, by forward "
         "differences.",
         "Drei Wege zu Phongs Bild mit weniger Summen: nur wo ein Glanzlicht liegen kann, mit einem Polynom, mit "
         "Vorwärtsdifferenzen.",
         "Τρεις δρόμοι προς την εικόνα του Phong με λιγότερα αθροίσματα: μόνο όπου μπορεί να υπάρχει κηλίδα, με "
         "πολυώνυμο, με πρόσθιες διαφορές."}},
    LectureText{"C12",
                "eine Szene durch alle Stufen",
                "μία σκηνή σε όλα τα στάδια",
                {"From wireframe to recursive rays, umbra shading draws the same scene in nine stages: each picture "
                 "adds one term.",
                 "Vom Drahtgitter bis zu rekursiven Strahlen zeichnet umbra shading dieselbe Szene in neun Stufen: "
                 "Jedes Bild fügt einen Term hinzu.",
                 "Από το συρματόπλεγμα ως τις αναδρομικές ακτίνες, η εντολή umbra shading σχεδιάζει την ίδια σκηνή σε "
                 "εννέα στάδια: κάθε εικόνα προσθέτει έναν όρο."}},

    LectureText{
        "D1",
        "Projektion auf Ebenen",
        "προβολή σε επίπεδα",
        {"On a plane the shadow is the projection of its occluder. The risers are too small to be receivers: the "
         "method "
         "has no answer there, and the picture shows them lit.",
         "Auf einer Ebene ist der Schatten die Projektion des Hindernisses. Die Setzstufen sind als Empfänger zu "
         "klein: dort hat das Verfahren keine Antwort, und das Bild zeigt sie beleuchtet.",
         "Σε ένα επίπεδο η σκιά είναι η προβολή του εμποδίου. Τα ρίχτια είναι πολύ μικρά για δέκτες: εκεί η "
         "μέθοδος δεν έχει απάντηση, και η εικόνα τα δείχνει φωτισμένα."}},
    LectureText{
        "D2",
        "Schatten im Scanline-Verfahren",
        "σκιές με γραμμές σάρωσης",
        {"On one plane with one light, edges projected from the light cut each span into lit and dark parts.",
         "Auf einer Ebene mit einer Lichtquelle teilen projizierte Kanten jede Spanne in helle und dunkle Stücke.",
         "Σε ένα επίπεδο με μία πηγή, οι προβεβλημένες ακμές κόβουν κάθε διάστημα σε φωτεινά και σκοτεινά μέρη."}},
    LectureText{
        "D3",
        "Schattenvolumen",
        "όγκοι σκιάς",
        {"Meshes with holes and turned faces have no inside, and still cast the right shadow if each edge counts as "
         "often as its faces say.",
         "Netze mit Löchern und gedrehten Flächen haben kein Inneres und werfen doch den richtigen Schatten, wenn "
         "jede Kante so oft zählt, wie ihre Flächen es sagen.",
         "Πλέγματα με τρύπες και ανεστραμμένες έδρες δεν έχουν εσωτερικό, κι όμως ρίχνουν σωστή σκιά, αν κάθε ακμή "
         "μετρά όσες φορές λένε οι έδρες της."}},
    LectureText{"D4",
                "beleuchtete Polygone",
                "φωτισμένα πολύγωνα",
                {"Surfaces that the light does not see are cut away once; what is left is lit for every camera.",
                 "Was die Lichtquelle nicht sieht, wird einmal abgeschnitten; der Rest ist für jede Kamera beleuchtet.",
                 "Ό,τι δεν βλέπει η πηγή αποκόπτεται μία φορά· το υπόλοιπο είναι φωτισμένο για κάθε κάμερα."}},
    LectureText{
        "D5",
        "Schatten-z-Puffer",
        "z-buffer σκιάς",
        {"Thin boards in grazing light are what a depth map finds hardest: texels are wider than the shadows.",
         "Dünne Latten in streifendem Licht sind für eine Tiefenkarte am schwersten: Ihre Texel sind breiter als die "
         "Schatten.",
         "Λεπτές σανίδες σε πλάγιο φως είναι το δυσκολότερο για έναν χάρτη βάθους: τα texel του είναι πλατύτερα από "
         "τις σκιές."}},
    LectureText{"D6",
                "Schattenstrahlen",
                "ακτίνες σκιάς",
                {"Rays to many points of the light count which part of it is seen.",
                 "Strahlen zu vielen Punkten der Lichtquelle zählen, welcher Teil von ihr zu sehen ist.",
                 "Ακτίνες προς πολλά σημεία της πηγής μετρούν ποιο μέρος της φαίνεται."}},
    LectureText{
        "D7",
        "Radiosity",
        "radiosity (αμοιβαία ακτινοβολία)",
        {"Patches exchange light, so that penumbrae come with the direct light, at the fineness of the patches.",
         "Flächenstücke tauschen Licht aus; Halbschatten entstehen von selbst, so fein wie die Stücke.",
         "Τα τμήματα των επιφανειών ανταλλάσσουν φως· οι παρασκιές προκύπτουν μόνες τους, όσο λεπτά είναι τα "
         "τμήματα."}},
    LectureText{"D8",
                "Kern- und Halbschatten, unterschieden",
                "κύρια σκιά και παρασκιά, σε διάκριση",
                {"Behind an occluder lies an umbra, where S_j is 0, and around it a penumbra, where the point sees a "
                 "part of the "
                 "light.",
                 "Hinter einem Hindernis liegt der Kernschatten mit S_j = 0, um ihn der Halbschatten, aus dem man "
                 "einen Teil der "
                 "Lichtquelle sieht.",
                 "Πίσω από ένα εμπόδιο βρίσκεται η κύρια σκιά, όπου S_j = 0, και γύρω της η παρασκιά, από όπου "
                 "φαίνεται μέρος της "
                 "πηγής."}},
    LectureText{
        "D9",
        "der Ort der Lichtquelle",
        "η θέση της πηγής",
        {"With the only light at the eye, no shadow is seen: what the eye sees, the light sees.",
         "Liegt die einzige Lichtquelle am Auge, sieht man keinen Schatten: Was das Auge sieht, sieht auch sie.",
         "Με τη μόνη πηγή στο μάτι δεν φαίνεται σκιά: ό,τι βλέπει το μάτι, το βλέπει και η πηγή."}},
    LectureText{"D10",
                "Punktlichtquellen werfen nur Kernschatten",
                "οι σημειακές πηγές δίνουν μόνο κύρια σκιά",
                {"The edge of the shadow is sharp: S_j of a point light is 0 or 1 and nothing between.",
                 "Der Rand des Schattens ist scharf: S_j einer Punktlichtquelle ist 0 oder 1 und nichts dazwischen.",
                 "Το όριο της σκιάς είναι οξύ: το S_j μιας σημειακής πηγής είναι 0 ή 1 και τίποτα ενδιάμεσο."}},
    LectureText{
        "D11",
        "was neu berechnet wird, wenn sich etwas bewegt",
        "τι υπολογίζεται ξανά όταν κάτι κινείται",
        {"Shadows depend on lights and objects alone; which methods use that, the table of build, aim and visibility "
         "shows.",
         "Schatten hängen nur von Lichtquellen und Objekten ab; welche Verfahren das nutzen, zeigt die Tabelle der "
         "Zeiten.",
         "Οι σκιές εξαρτώνται μόνο από πηγές και αντικείμενα· ποιες μέθοδοι το εκμεταλλεύονται δείχνει ο πίνακας "
         "των χρόνων."}},
    LectureText{
        "D12",
        "der ambiente Term bleibt im Schatten",
        "ο όρος περιβάλλοντος μένει στη σκιά",
        {"S_j scales the light's own terms alone: emission and ambient light stay in the umbra.",
         "S_j wirkt nur auf die Terme der Lichtquelle: Emission und Umgebungslicht bleiben im Kernschatten.",
         "Το S_j επηρεάζει μόνο τους όρους της πηγής: η εκπομπή και το φως περιβάλλοντος μένουν στην κύρια σκιά."}},
    LectureText{"D13",
                "was der Ort der Lichtquelle kostet",
                "τι κοστίζει η θέση της πηγής",
                {"One scene under a light at infinity, outside the view, inside it and at the eye: umbra compare "
                 "light_places@0..3 measures what each place costs each method.",
                 "Eine Szene mit der Lichtquelle im Unendlichen, außerhalb des Bildes, im Bild und am Auge: umbra "
                 "compare light_places@0..3 misst, was jeder Ort jedes Verfahren kostet.",
                 "Μία σκηνή με την πηγή στο άπειρο, έξω από την εικόνα, μέσα σε αυτήν και στο μάτι: η εντολή umbra "
                 "compare light_places@0..3 μετρά τι κοστίζει κάθε θέση σε κάθε μέθοδο."}},
    LectureText{
        "D14",
        "drei Lichtquellen, drei Gründe",
        "τρεις πηγές, τρεις αιτίες",
        {"The hollow faces away from one light, the board hides the second, and the ring itself hides the third.",
         "Die Höhlung ist der ersten Lichtquelle abgewandt, das Brett verdeckt die zweite, der Ring selbst die dritte.",
         "Το κοίλωμα κοιτά μακριά από την πρώτη πηγή, η σανίδα κρύβει τη δεύτερη και ο ίδιος ο δακτύλιος την τρίτη."}},
    LectureText{"D15",
                "Energie aus S_j",
                "ενέργεια από το S_j",
                {"The light that arrives at an object is the sum of S_j over its surface: umbra energy adds it up over "
                 "a day, frame by frame.",
                 "Das Licht, das ein Objekt empfängt, ist die Summe von S_j über seine Fläche: umbra energy addiert es "
                 "über einen Tag, Bild für Bild.",
                 "Το φως που δέχεται ένα αντικείμενο είναι το άθροισμα του S_j στην επιφάνειά του: η εντολή umbra "
                 "energy το αθροίζει σε μία ημέρα, καρέ προς καρέ."}},
    LectureText{
        "D16",
        "verdeckte Schatten rauer Flächen",
        "απόκρυψη σκιών σε τραχείς επιφάνειες",
        {"Seen along the sun's direction rough ground hides its shadows; against the sun they cover much of it.",
         "In Richtung der Sonne gesehen verdeckt rauer Boden seine Schatten; gegen die Sonne bedecken sie viel von "
         "ihm.",
         "Κοιτώντας προς την κατεύθυνση του ήλιου το τραχύ έδαφος κρύβει τις σκιές του· αντίθετα προς τον ήλιο "
         "καλύπτουν μεγάλο μέρος του."}},

    LectureText{"E1",
                "Rekursion",
                "αναδρομή",
                {"A mirror seen in a mirror: rays follow rays, down to a depth of 5, and those that add too little are "
                 "not traced.",
                 "Ein Spiegel im Spiegel: Strahlen folgen Strahlen bis zur Tiefe 5; was zu wenig beiträgt, wird nicht "
                 "verfolgt.",
                 "Καθρέφτης μέσα σε καθρέφτη: ακτίνες ακολουθούν ακτίνες έως βάθος 5· όσες προσφέρουν πολύ λίγο δεν "
                 "ανιχνεύονται."}},
    LectureText{
        "E2",
        "Kugel und Quader als Formel",
        "σφαίρα και κουτί με τύπο",
        {"The same scene with balls and boxes as triangles and by formula: only their outlines differ, and what "
         "glass bends.",
         "Dieselbe Szene mit Kugeln und Quadern aus Dreiecken und per Formel: Nur Umrisse sind verschieden und "
         "was Glas bricht.",
         "Η ίδια σκηνή με σφαίρες και κουτιά από τρίγωνα και με τύπο: διαφέρουν μόνο τα περιγράμματα και ό,τι "
         "διαθλά το γυαλί."}},
    LectureText{
        "E3",
        "Überabtastung",
        "υπερδειγματοληψία",
        {"Edges seen in mirrors and through glass are smooth with more rays a pixel.",
         "Kanten in Spiegeln und hinter Glas werden mit mehr Strahlen je Bildpunkt glatt.",
         "Οι ακμές μέσα σε καθρέφτες και πίσω από γυαλί γίνονται λείες με περισσότερες ακτίνες ανά εικονοστοιχείο."}},
    LectureText{
        "E4",
        "wohin die Zeit geht",
        "πού πηγαίνει ο χρόνος",
        {"umbra whitted measures how much of the time goes into intersections, how much into shadows and shading.",
         "umbra whitted misst, wie viel Zeit in Schnitte geht und wie viel in Schatten und Beleuchtung.",
         "Η εντολή umbra whitted μετρά πόσος χρόνος πηγαίνει στις τομές και πόσος στις σκιές και τον φωτισμό."}},
    LectureText{
        "E5",
        "alle Dreiecke gegen Bäume",
        "όλα τα τρίγωνα ή δέντρα",
        {"Testing every triangle for every ray costs rays times triangles; a tree finds the same points.",
         "Jedes Dreieck für jeden Strahl zu prüfen kostet Strahlen mal Dreiecke; ein Baum findet dieselben Punkte.",
         "Ο έλεγχος κάθε τριγώνου για κάθε ακτίνα κοστίζει ακτίνες επί τρίγωνα· ένα δέντρο βρίσκει τα ίδια σημεία."}},
    LectureText{
        "E6",
        "was Strahlverfolgung nicht sehen kann",
        "τι δεν βλέπει η ανίχνευση ακτίνων",
        {"Light that a mirror would throw on the floor is missing: shadow rays look straight at the lamp.",
         "Licht, das ein Spiegel auf den Boden würfe, fehlt: Schattenstrahlen blicken geradewegs zur Lampe.",
         "Το φως που θα έριχνε ένας καθρέφτης στο δάπεδο λείπει: οι ακτίνες σκιάς κοιτούν κατευθείαν τη λάμπα."}},
    LectureText{
        "E7",
        "Strahlen nur, wo Flächen spiegeln",
        "ακτίνες μόνο όπου οι επιφάνειες ανακλούν",
        {"Only mirrors and glass need rays; everything else comes from the raster, and the picture is the same.",
         "Nur Spiegel und Glas brauchen Strahlen; alles andere kommt aus dem Raster, und das Bild ist dasselbe.",
         "Μόνο οι καθρέφτες και το γυαλί χρειάζονται ακτίνες· όλα τα άλλα έρχονται από το πλέγμα, και η εικόνα είναι η "
         "ίδια."}},
    LectureText{"E8", "Beleuchtung im falschen Raum", "φωτισμός σε λάθος χώρο", {}},

    LectureText{"F1",
                "alle Verfahren auf einer Szene, ein Bericht",
                "όλες οι μέθοδοι σε μία σκηνή, μία αναφορά",
                {"Every method answers one question at the same points: pictures differ in their shadows alone.",
                 "Jedes Verfahren beantwortet eine Frage an denselben Punkten: Bilder unterscheiden sich nur in den "
                 "Schatten.",
                 "Κάθε μέθοδος απαντά σε μία ερώτηση στα ίδια σημεία: οι εικόνες διαφέρουν μόνο στις σκιές."}},
    LectureText{
        "F2",
        "Schnelligkeit gegen Genauigkeit: Reihe, Front, Empfehlung",
        "ταχύτητα και ακρίβεια: σειρά, μέτωπο, σύσταση",
        {"Each setting of a method has a time and an error; the front holds those that no other beats in both.",
         "Jede Einstellung eines Verfahrens hat eine Zeit und einen Fehler; auf der Front liegen die, die keine "
         "andere in beidem übertrifft.",
         "Κάθε ρύθμιση μιας μεθόδου έχει χρόνο και σφάλμα· στο μέτωπο είναι όσες δεν ξεπερνά καμία άλλη και στα "
         "δύο."}},
    LectureText{"F3", "Leitern: wo Verfahren versagen", "κλίμακες: πού αποτυγχάνουν οι μέθοδοι", {}},
    LectureText{
        "F4",
        "nur, was eine Szene verlangt",
        "μόνο ό,τι ζητά η σκηνή",
        {"One light and one plane ask for no attenuation, no spot and no area: none of it is computed.",
         "Eine Lichtquelle und eine Ebene verlangen weder Abschwächung noch Spot noch Fläche: Nichts davon wird "
         "berechnet.",
         "Μία πηγή και ένα επίπεδο δεν ζητούν εξασθένιση, προβολέα ή επιφάνεια: τίποτα από αυτά δεν υπολογίζεται."}},
    LectureText{"F5",
                "eine exakte Referenz",
                "μία ακριβής αναφορά",
                {"The share of the disk that is seen is computed as an area, with a bound, and not by sampling.",
                 "Der sichtbare Anteil der Scheibe wird als Fläche mit Fehlerschranke berechnet, nicht abgetastet.",
                 "Το ορατό μέρος του δίσκου υπολογίζεται ως εμβαδόν με φράγμα σφάλματος, όχι με δειγματοληψία."}},
    LectureText{"F6",
                "Tests durch Bildvergleich",
                "έλεγχοι με σύγκριση εικόνων",
                {"Accepted planes of S_j gate each change of the program.",
                 "Abgenommene S_j-Bilder sichern jede Änderung am Programm ab.",
                 "Εγκεκριμένες εικόνες S_j ελέγχουν κάθε αλλαγή του προγράμματος."}},
    LectureText{"F7",
                "ein Bericht zur Vorlesung",
                "μία αναφορά για το μάθημα",
                {"This page: every topic of the lectures, with the picture that shows it.",
                 "Diese Seite: jedes Thema der Vorlesungen mit dem Bild, das es zeigt.",
                 "Αυτή η σελίδα: κάθε θέμα των διαλέξεων με την εικόνα που το δείχνει."}},
    LectureText{"F8",
                "ein neues Verfahren ist eine Datei und eine Zeile",
                "μία νέα μέθοδος είναι ένα αρχείο και μία γραμμή",
                {}},
};

constexpr std::array kChapters{
    LectureChapter{
        'A',
        {"Light sources", "Lichtquellen", "Φωτεινές πηγές"},
        {Exercise{
             {"A ball has radius 1, a sun at infinity lights it. Which share of its surface is lit? And by a point "
              "light at distance 2 from its centre?",
              "Eine Kugel vom Radius 1 wird von einer Sonne im Unendlichen beleuchtet. Welcher Teil ihrer Oberfläche "
              "ist beleuchtet? Und von einer Punktlichtquelle im Abstand 2 vom Mittelpunkt?",
              "Μια σφαίρα ακτίνας 1 φωτίζεται από έναν ήλιο στο άπειρο. Ποιο μέρος της επιφάνειάς της φωτίζεται; Και "
              "από σημειακή πηγή σε απόσταση 2 από το κέντρο;"},
             {"One half; (1 − 1/2) / 2 = one quarter.", "Die Hälfte; (1 − 1/2) / 2 = ein Viertel.",
              "Το μισό· (1 − 1/2) / 2 = ένα τέταρτο."}},
         Exercise{
             {"A lamp of intensity I = 100 cd hangs 2 m above a floor. How large is the irradiance below it, and 2 m "
              "to the side?",
              "Eine Lampe der Stärke I = 100 cd hängt 2 m über dem Boden. Wie groß ist die Beleuchtungsstärke "
              "unter ihr und 2 m daneben?",
              "Μια λάμπα έντασης I = 100 cd κρέμεται 2 m πάνω από το δάπεδο. Πόσος είναι ο φωτισμός ακριβώς από κάτω "
              "και 2 m πιο δίπλα;"},
             {"100 / 4 = 25 lx; the distance there is √8 m and the angle 45°: 100 · cos 45° / 8 = 8.8 lx.",
              "100 / 4 = 25 lx; dort ist der Abstand √8 m und der Winkel 45°: 100 · cos 45° / 8 = 8,8 lx.",
              "100 / 4 = 25 lx· εκεί η απόσταση είναι √8 m και η γωνία 45°: 100 · cos 45° / 8 = 8,8 lx."}}}},
    LectureChapter{
        'B',
        {"Illumination", "Beleuchtung", "Φωτισμός"},
        {Exercise{
             {"A plane has k_d = 0.8, and the sun is 60° from its normal. How bright is the diffuse term for I = 1?",
              "Eine Ebene hat k_d = 0,8, die Sonne steht 60° von der Normalen entfernt. Wie groß ist der diffuse Term "
              "für I = 1?",
              "Ένα επίπεδο έχει k_d = 0,8 και ο ήλιος απέχει 60° από την κανονική. Πόσος είναι ο διάχυτος όρος για "
              "I = 1;"},
             {"0.8 cos 60° = 0.4.", "0,8 cos 60° = 0,4.", "0,8 cos 60° = 0,4."}},
         Exercise{
             {"The light is 30° to one side of the normal and the eye 50° to the other side, in one plane. Which "
              "angles "
              "do Phong and Blinn take the cosine of?",
              "Das Licht steht 30° auf der einen Seite der Normalen, das Auge 50° auf der anderen, in einer Ebene. Von "
              "welchen Winkeln nehmen Phong und Blinn den Kosinus?",
              "Το φως απέχει 30° από τη μία πλευρά της κανονικής και το μάτι 50° από την άλλη, σε ένα επίπεδο. Ποιων "
              "γωνιών το συνημίτονο παίρνουν ο Phong και ο Blinn;"},
             {"Phong 20° between R and V, Blinn 10° between N and H: half as much, so that Blinn's exponent is about "
              "four times Phong's.",
              "Phong 20° zwischen R und V, Blinn 10° zwischen N und H: halb so viel, darum ist Blinns Exponent etwa "
              "viermal so groß wie der von Phong.",
              "Ο Phong 20° μεταξύ R και V, ο Blinn 10° μεταξύ N και H: το μισό, γι' αυτό ο εκθέτης του Blinn είναι "
              "περίπου τετραπλάσιος."}}}},
    LectureChapter{
        'C',
        {"Shading, transparency, fog", "Schattierung, Transparenz, Nebel", "Φωτοσκίαση, διαφάνεια, ομίχλη"},
        {Exercise{{"A highlight falls into the middle of a large triangle. What does Gouraud shading make of it?",
                   "Ein Glanzlicht fällt mitten in ein großes Dreieck. Was macht die Gouraud-Schattierung daraus?",
                   "Μια στιλπνή κηλίδα πέφτει στη μέση ενός μεγάλου τριγώνου. Τι κάνει με αυτήν η φωτοσκίαση Gouraud;"},
                  {"Nothing is left of it: the sum is evaluated at the vertices alone.",
                   "Es verschwindet: Die Summe wird nur an den Ecken ausgewertet.",
                   "Χάνεται: το άθροισμα υπολογίζεται μόνο στις κορυφές."}},
         Exercise{
             {"Two sheets let 60 and 30 per cent of the light through. How much arrives behind both, and does their "
              "order matter?",
              "Zwei Folien lassen 60 und 30 Prozent des Lichts durch. Wie viel kommt hinter beiden an, und kommt es "
              "auf die Reihenfolge an?",
              "Δύο φύλλα αφήνουν το 60 και το 30 τοις εκατό του φωτός να περάσει. Πόσο φτάνει πίσω και από τα δύο, και "
              "έχει σημασία η σειρά τους;"},
             {"0.6 · 0.3 = 18 per cent in either order; but which colours the eye sees does depend on the order.",
              "0,6 · 0,3 = 18 Prozent in jeder Reihenfolge; welche Farben das Auge sieht, hängt aber von ihr ab.",
              "0,6 · 0,3 = 18 τοις εκατό με όποια σειρά· όμως τα χρώματα που βλέπει το μάτι εξαρτώνται από αυτήν."}}}},
    LectureChapter{
        'D',
        {"Shadows", "Schatten", "Σκιές"},
        {Exercise{
             {"A disk light of radius 1 is 4 above the floor; a ball of radius 0.5 hangs half-way. How wide is the "
              "umbra "
              "about?",
              "Eine Scheibe vom Radius 1 leuchtet 4 über dem Boden; eine Kugel vom Radius 0,5 hängt auf halber Höhe. "
              "Wie "
              "breit ist der Kernschatten etwa?",
              "Ένας φωτεινός δίσκος ακτίνας 1 βρίσκεται 4 πάνω από το δάπεδο· μια σφαίρα ακτίνας 0,5 κρέμεται στη "
              "μέση. "
              "Πόσο πλατιά είναι περίπου η κύρια σκιά;"},
             {"It just vanishes: the lines from the light's rim past the ball meet on the floor (2 · 0.5 − 1 = 0).",
              "Er verschwindet gerade: Die Linien vom Rand der Lichtquelle an der Kugel vorbei treffen sich am Boden "
              "(2 · 0,5 − 1 = 0).",
              "Μόλις εξαφανίζεται: οι ευθείες από το χείλος της πηγής δίπλα στη σφαίρα συναντιούνται στο δάπεδο "
              "(2 · 0,5 − 1 = 0)."}},
         Exercise{
             {"The texels of a depth map are 2 cm wide. How long is one on the floor under a sun 5° above the horizon?",
              "Die Texel einer Tiefenkarte sind 2 cm breit. Wie lang ist eines auf dem Boden unter einer Sonne 5° über "
              "dem Horizont?",
              "Τα στοιχεία ενός χάρτη βάθους έχουν πλάτος 2 cm. Πόσο μήκος έχει ένα στο δάπεδο κάτω από ήλιο 5° πάνω "
              "από "
              "τον ορίζοντα;"},
             {"2 cm / sin 5° = 23 cm: the bias that it needs grows by the same factor.",
              "2 cm / sin 5° = 23 cm: Um denselben Faktor wächst der Bias, den es braucht.",
              "2 cm / sin 5° = 23 cm: με τον ίδιο παράγοντα μεγαλώνει το bias που χρειάζεται."}}}},
    LectureChapter{
        'E',
        {"Ray tracing", "Strahlverfolgung", "Ανίχνευση ακτίνων"},
        {Exercise{{"A lamp shines on a mirror, the mirror on a wall. Why does no method here brighten the wall?",
                   "Eine Lampe beleuchtet einen Spiegel, der Spiegel eine Wand. Warum wird die Wand hier nicht heller?",
                   "Μια λάμπα φωτίζει έναν καθρέφτη και ο καθρέφτης έναν τοίχο. Γιατί εδώ ο τοίχος δεν γίνεται "
                   "φωτεινότερος;"},
                  {"S_j asks for the straight line to the light alone.",
                   "S_j fragt nur nach der geraden Linie zur Lichtquelle.",
                   "Το S_j ρωτά μόνο για την ευθεία προς την πηγή."}},
         Exercise{
             {"Two mirrors with k_r = 0.5 face each other. From which depth on does a ray change an 8-bit value by "
              "less "
              "than one step, if the light at its end is 1?",
              "Zwei Spiegel mit k_r = 0,5 stehen sich gegenüber. Ab welcher Tiefe ändert ein Strahl einen 8-Bit-Wert "
              "um "
              "weniger als eine Stufe, wenn an seinem Ende das Licht 1 ist (ohne sRGB-Kurve)?",
              "Δύο καθρέφτες με k_r = 0,5 βρίσκονται απέναντι. Από ποιο βάθος και μετά μια ακτίνα αλλάζει μια τιμή των "
              "8 "
              "bit λιγότερο από ένα βήμα, αν το φως στο τέλος της είναι 1 (χωρίς την καμπύλη sRGB);"},
             {"The eye ray has depth 1 and weight 1, so that depth n has 0.5 to the power of n − 1; it is below 1/255 "
              "from depth 9 on (1/256).",
              "Der Augstrahl hat Tiefe 1 und Gewicht 1, Tiefe n also 0,5 hoch n − 1; das ist ab Tiefe 9 (1/256) "
              "kleiner "
              "als 1/255.",
              "Η ακτίνα από το μάτι έχει βάθος 1 και βάρος 1, άρα το βάθος n έχει 0,5 στη δύναμη n − 1· αυτό είναι "
              "μικρότερο από 1/255 από το βάθος 9 (1/256)."}}}},
    LectureChapter{
        'F',
        {"The testbed", "Das Testbett", "Το πεδίο δοκιμών"},
        {Exercise{{"A method errs at 0 of 300 points. How large may its error rate be?",
                   "Ein Verfahren irrt an 0 von 300 Punkten. Wie groß kann seine Fehlerrate sein?",
                   "Μια μέθοδος σφάλλει σε 0 από 300 σημεία. Πόσο μεγάλο μπορεί να είναι το ποσοστό σφαλμάτων της;"},
                  {"With 95 % confidence up to 3/300 = 1 %.", "Mit 95 % Sicherheit bis zu 3/300 = 1 %.",
                   "Με βεβαιότητα 95 % έως 3/300 = 1 %."}},
         Exercise{
             {"With 16 random rays to an area light a penumbra point with S_j = 0.5 is estimated. How large is the "
              "standard error, and how many rays halve it?",
              "Mit 16 zufälligen Strahlen zu einer Flächenlichtquelle wird ein Halbschattenpunkt mit S_j = 0,5 "
              "geschätzt. Wie groß ist der Standardfehler, und wie viele Strahlen halbieren ihn?",
              "Με 16 τυχαίες ακτίνες προς μια εκτεταμένη πηγή εκτιμάται ένα σημείο παρασκιάς με S_j = 0,5. Πόσο είναι "
              "το τυπικό σφάλμα και πόσες ακτίνες το μειώνουν στο μισό;"},
             {"√(0.5 · 0.5 / 16) = 0.125; four times as many, 64. Stratified rays do better: that is measured on the "
              "page of the trade.",
              "√(0,5 · 0,5 / 16) = 0,125; viermal so viele, 64. Geschichtete Strahlen sind besser: Das ist auf der "
              "Seite der Abwägung gemessen.",
              "√(0,5 · 0,5 / 16) = 0,125· τετραπλάσιες, 64. Οι στρωματοποιημένες ακτίνες τα πάνε καλύτερα: αυτό "
              "μετριέται στη σελίδα της ανταλλαγής."}}}},
};

constexpr LecturePhrases kPhrases{
    .title = {"The lectures, in pictures", "Die Vorlesungen in Bildern", "Οι διαλέξεις σε εικόνες"},
    .lead =
        {"Each topic of the lectures, with the picture that shows it, what the picture proves, and what was measured "
         "on it.",
         "Jedes Thema der Vorlesungen mit dem Bild, das es zeigt, was das Bild beweist und was daran gemessen wurde.",
         "Κάθε θέμα των διαλέξεων με την εικόνα που το δείχνει, τι αποδεικνύει η εικόνα και τι μετρήθηκε σε αυτήν."},
    .works    = {"works", "geht", "λειτουργεί"},
    .in_part  = {"in part", "zum Teil", "εν μέρει"},
    .not_yet  = {"not yet", "noch nicht", "όχι ακόμη"},
    .measured = {"Measured", "Gemessen", "Μετρήθηκε"},
    .exercise = {"Exercise", "Aufgabe", "Άσκηση"},
    .answer   = {"Answer", "Antwort", "Απάντηση"},
    .source   = {"Source", "Quelle", "Πηγή"},
    .back     = {"The report", "Der Bericht", "Η αναφορά"}};

}  // namespace

std::optional<Language> language_named(std::string_view code) {
    for (const auto& [name, language] : kLanguages)
        if (name == code) return language;
    return std::nullopt;
}

std::string_view code_of(Language language) {
    for (const auto& [name, known] : kLanguages)
        if (known == language) return name;
    return "en";
}

std::string_view Translated::in(Language language) const {
    switch (language) {
        case Language::german: return de;
        case Language::greek: return el;
        case Language::english: break;
    }
    return en;
}

std::span<const LectureText> lecture_texts() { return kTexts; }
std::span<const LectureChapter> lecture_chapters() { return kChapters; }
const LecturePhrases& lecture_phrases() { return kPhrases; }

}  // namespace umbra
