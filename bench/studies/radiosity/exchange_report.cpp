#include <fmt/format.h>

#include "report_assets.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"

namespace umbra {

StudyReport exchange_report(const ExchangeRecord& record) {
    const std::string& title = record.scene.title;
    std::vector<StudyPicture> light{
        {"direct.png", "The scene, lit by its lights alone",
         "Direct: what lights send. Every patch has the value of its centre."},
        {"indirect.png", "The scene, lit by its surfaces alone",
         "Indirect: what surfaces send, interpolated between the corners of patches."},
        {"both.png", "The scene, lit by lights and surfaces", "Both."},
        {"patches.png", "The scene, each patch in a colour of its own", "The patches."},
        {"form_factors.png", "The scene, brighter where the form factor to one patch is larger",
         "Form factors to the patch that sent first (orange): white 1, black 10⁻⁶ or hidden."}};
    for (const LightElementsRecord& entry : record.elements)
        light.push_back({entry.picture, "The scene, each element in a colour of its own",
                         fmt::format("Elements of S_j of `{}` in the method `radiosity`: patches are cut where S_j "
                                     "changes; the darker, the less of the light arrives.",
                                     entry.light)});
    StudyTable convergence{.name    = "unshot",
                           .caption = "Share of the power that was not sent yet",
                           .columns = {{"step", "step", kCount}, {"unshot", "unshot", kSignificant}},
                           .rows    = Json::array(),
                           .shown   = Shown::in_file};
    for (const double unshot : record.unshot)
        convergence.rows.push_back({{"step", convergence.rows.size()}, {"unshot", number(unshot)}});
    return {.title    = "Radiosity: " + title,
            .page     = assets::radiosity_html,
            .tables   = {std::move(convergence)},
            .pictures = {{"light", std::move(light)}},
            .curves = {{"steps", "fraction of the power unshot", "Convergence: what was not sent yet.", record.unshot}},
            .sentences = {{fmt::format("{} patches, {} steps, {:.3g} % of the power unshot",
                                       count(static_cast<double>(record.patches)),
                                       count(static_cast<double>(record.steps)), 100 * record.unshot.back())}},
            .words     = {{"title", title}, {"arrived", fmt::format("{:.1f} %", 100 * record.arrived)}}};
}

}  // namespace umbra
