#include "umbra/bench/view/view_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/compare/pictures.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/pages/error_palette.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/render/light_points.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

/// At about how many points area lights are judged first.
constexpr std::uint64_t kFirstSample = 1500;

std::vector<double> numbers(dvec3 v) { return {v.x, v.y, v.z}; }

void append_bytes(const Image& image, std::vector<std::uint8_t>& bytes) {
    const std::size_t begin = bytes.size(), channels = image.channels.size();
    bytes.resize(begin + 3 * image.pixels());
    parallel_ranges(image.pixels(), 8192, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const float value        = image.at(i, std::min(c, channels - 1));
                bytes[begin + 3 * i + c] = static_cast<std::uint8_t>(
                    std::lround(255 * (std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 0.0f)));
            }
    });
}

/// Places along each side of the light at which it is looked for.
constexpr int kSeenSide = 48;

Image final_picture(const Scene& scene, const PointBatch& points, const std::vector<VisibilityPlane>& planes) {
    return displayed(shade(scene, points, planes), scene.tone, scene.exposure);
}

}  // namespace

Moved ViewSession::place(const ViewRequest& request) {
    Moved moved = posed_.place(request);
    if (moved.all) sides_.clear();
    const std::size_t lights = posed_.scene().lights.size();
    const bool any = moved.camera || moved.objects || std::ranges::find(moved.lights, true) != moved.lights.end();
    if (moved.objects) rays_.reset();
    if (any) truth_.reset(), truth_level_ = 0, truth_failed_.clear();
    for (Side& side : sides_) {
        if (moved.objects) side.due = frame_work(Movement::object, lights, 0);
        side.due.look = side.due.look || moved.camera;
        for (std::size_t j = 0; j < lights; ++j) side.due.aim[j] = side.due.aim[j] || moved.lights[j];
    }
    return moved;
}

void ViewSession::run(Side& side, const MethodChoice& choice, const Budget& most, bool again) {
    const std::size_t lights = posed_.scene().lights.size();
    if (side.method && side.method->choice().info == choice.info) {
        const FrameWork work = side.method->set(choice);
        side.due.build       = side.due.build || work.build;
        side.due.look        = side.due.look || work.look;
        for (std::size_t j = 0; j < lights; ++j) side.due.aim[j] = side.due.aim[j] || work.aim[j];
    } else {
        side.method = std::make_unique<KeptMethod>(choice, posed_.scene(), posed_.facts(), wall_clock_ms, most);
        side.due    = frame_work(Movement::object, lights, 0);
    }
    const bool due = side.due.build || side.due.look || std::ranges::find(side.due.aim, true) != side.due.aim.end();
    if (!again && !due && side.failed.empty()) return;
    side.failed.clear();
    side.done  = side.due;
    side.times = {0, std::vector<double>(lights), 0, std::vector<double>(lights)};
    if (!side.method->service()) return;
    try {
        side.times = side.method->run(side.due, posed_.points());
        side.due   = {false, std::vector<bool>(lights, false), false};
    } catch (...) {
        side.failed = current_message();
        side.due    = frame_work(Movement::object, lights, 0);
    }
}

SideRecord ViewSession::side_record(const Side& side) const {
    const MethodChoice& choice = side.method->choice();
    SideRecord record{.method = choice.text(),
                      .title  = std::string(choice.info->title),
                      .serves = service_record(side.method->service()),
                      .failed = side.failed,
                      .layer  = "nothing"};
    if (!side.method->service() || !side.failed.empty()) return record;
    const bool aimed    = std::ranges::find(side.done.aim, true) != side.done.aim.end();
    record.phases       = {{"build", side.times.build, side.done.build},
                           {"aim", side.times.aims(), aimed},
                           {"look", side.times.look, side.done.look},
                           {"visibility", side.times.visibilities(), true}};
    record.memory_bytes = side.method->memory_bytes();
    return record;
}

void ViewSession::find_truth(const ViewRequest& request, const Budget& most) {
    if (request.truth <= truth_level_) return;
    truth_level_ = request.truth;
    truth_failed_.clear();
    reference_ = default_reference(posed_.facts());
    try {
        const std::optional<std::uint64_t> wanted = request.truth == 1 ? std::optional(kFirstSample) : std::nullopt;
        truth_ms_                                 = timed_ms([&] {
            truth_ = run_reference(*reference_, posed_.scene(), posed_.facts(), posed_.points(), wanted, nullptr, most);
        });
    } catch (...) {
        truth_.reset();
        truth_failed_ = current_message();
    }
}

std::optional<Image> ViewSession::add_errors(const Side& side, const ViewRequest& request, SideRecord& record) const {
    const Scene& scene       = posed_.scene();
    const PointBatch& points = posed_.points();
    const auto light         = static_cast<LightId>(request.light);
    const Explained found    = explain(scene, points, light, side.method->as_run(), truth_->run);
    const VisibilityError& e = found.error;
    SideErrorRecord& errors  = record.errors.emplace();
    errors.points            = e.points;
    errors.undefined         = e.undefined;
    errors.on_boundary       = e.on_boundary;
    errors.wrong_interior    = e.false_shadow.interior + e.false_light.interior;
    if (e.points > 0) errors.rmse = e.rmse;
    for (const ErrorColour& row : kErrorPalette) {
        const auto n = static_cast<std::uint64_t>(std::ranges::count(found.classes, row.error_class));
        if (n > 0)
            errors.classes.push_back(
                {std::string(row.key), std::string(row.name), std::string(row.srgb), n, row.interior});
    }
    const std::vector<VisibilityPlane>&planes = side.method->planes(), &truths = truth_->run.planes;
    if (request.layer == "difference") return difference_picture(points, light, planes[light], truths[light]);
    if (request.layer == "classes") return class_picture(points, found.classes, truths[light]);
    if (request.layer != "flip") return std::nullopt;
    const Flip flip = flip_ldr(final_picture(scene, points, truths), final_picture(scene, points, planes));
    errors.flip     = flip.mean;
    return flip_picture(points, planes, flip.map);
}

ViewReply ViewSession::show(const ViewRequest& request, const Budget& most) {
    std::vector<MethodChoice> choices;
    for (const std::string& text : request.methods) choices.push_back(parse_method(text));
    const Moved moved        = place(request);
    const Scene& scene       = posed_.scene();
    const PointBatch& points = posed_.points();
    const auto light         = static_cast<LightId>(request.light);
    sides_.resize(choices.size());
    for (std::size_t k = 0; k < choices.size(); ++k) run(sides_[k], choices[k], most, true);
    if (request.truth > 0 && !scene.lights.empty()) find_truth(request, most);

    const int width = points.raster->width, height = points.raster->height;
    ViewReply reply;
    ViewRecord& record = reply.record;
    record.width = request.width, record.height = request.height;
    record.facts_ms = posed_.facts_ms(), record.points_ms = posed_.points_ms();
    record.camera_moved = moved.camera, record.object_moved = moved.objects;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        if (moved.lights[j]) record.lights_moved.push_back(scene.lights[j].name);
    const auto pictures = [&] {
        for (const Side& side : sides_) {
            SideRecord shown = side_record(side);
            Image picture(width, height, {"R", "G", "B"});
            if (!shown.phases.empty() && !scene.lights.empty()) {
                std::optional<Image> of_errors;
                if (truth_) of_errors = add_errors(side, request, shown);
                shown.layer = of_errors || request.layer == "picture" ? request.layer : "visibility";
                picture     = of_errors                    ? std::move(*of_errors)
                              : request.layer == "picture" ? final_picture(scene, points, side.method->planes())
                                                           : visibility_picture(points, side.method->planes()[light]);
            }
            append_bytes(picture, reply.pictures);
            record.sides.push_back(std::move(shown));
        }
        if (truth_ && sides_.size() == 1) {
            const bool whole = request.layer == "picture" || request.layer == "flip";
            append_bytes(whole ? final_picture(scene, points, truth_->run.planes)
                               : visibility_picture(points, truth_->run.planes[light]),
                         reply.pictures);
        }
    };
    record.pictures_ms = timed_ms(pictures);
    if (truth_level_ > 0) {
        ViewTruthRecord& truth = record.truth.emplace();
        truth.method           = reference_->choice.text();
        truth.exact = reference_->exact, truth.note = reference_->note, truth.failed = truth_failed_;
        if (truth_) truth.judged = truth_->judged, truth.of = truth_->of, truth.ms = truth_ms_;
    }
    return reply;
}

SeenLightRecord ViewSession::seen_light(std::size_t i, const Light& light) {
    const Scene& scene       = posed_.scene();
    const PointBatch& points = posed_.points();
    const dvec3 p            = exact_position(scene, points, i), n(points.normal(i));
    dvec3 centre(light.position), u = 0.5 * dvec3(light.edge_u), v = 0.5 * dvec3(light.edge_v);
    if (light.kind == LightKind::disk) {
        const DiskAxes axes = disk_axes(light);
        u = axes.u, v = axes.v;
    } else if (TangentDisk disk; light.kind == LightKind::sphere && tangent_disk(p, centre, light.radius, disk)) {
        centre = disk.centre, u = disk.axis_u, v = disk.axis_v;
    }
    if (!rays_) rays_.emplace(scene, Met::blocking);
    const RaySpace& space = rays_->space();
    SeenLightRecord seen{.side = kSeenSide, .aspect = glm::length(u) / glm::length(v)};
    seen.frame        = {numbers(centre), numbers(u), numbers(v)};
    std::uint64_t lit = 0, of = 0;
    const FlushDenormals flush;
    for (int row = 0; row < kSeenSide; ++row)
        for (int column = 0; column < kSeenSide; ++column) {
            const double a = (2 * column + 1.0) / kSeenSide - 1, b = 1 - (2 * row + 1.0) / kSeenSide;
            int& cell = seen.cells.emplace_back(SeenLightRecord::kNoLight);
            if (light.kind != LightKind::rectangle && a * a + b * b > 1) continue;
            ++of;
            const dvec3 way = centre + a * u + b * v - p;
            cell            = SeenLightRecord::kBehind;
            if (glm::dot(way, n) <= 0) continue;
            const vec3 from = space.point(p), along = space.vector(way);
            const TriangleId hit = rays_->first_hit({.org_x = from.x,
                                                     .org_y = from.y,
                                                     .org_z = from.z,
                                                     .tnear = 1e-5f,
                                                     .dir_x = along.x,
                                                     .dir_y = along.y,
                                                     .dir_z = along.z,
                                                     .tfar  = 1,
                                                     .id    = points.triangle[i]});
            const bool blocked   = hit != kNoTriangle && hit != points.triangle[i];
            cell                 = blocked ? static_cast<int>(scene.triangle_object[hit]) : SeenLightRecord::kLit;
            lit += blocked ? 0 : 1;
        }
    seen.fraction = static_cast<double>(lit) / static_cast<double>(of);
    return seen;
}

WhyHereRecord ViewSession::why(const ViewRequest& request, const Budget& most) {
    if (!request.x || !request.y || *request.x >= request.width || *request.y >= request.height)
        throw UsageError("no pixel, expected x and y within the picture");
    std::vector<MethodChoice> choices;
    for (const std::string& text : request.methods) choices.push_back(parse_method(text));
    static_cast<void>(place(request));
    const Scene& scene       = posed_.scene();
    const PointBatch& points = posed_.points();
    const std::size_t i      = *request.y * request.width + *request.x;
    const auto light         = static_cast<LightId>(request.light);
    if (points.triangle[i] == kNoTriangle || scene.lights.empty()) throw UsageError("no surface at this pixel");
    WhyHereRecord record{.on       = triangle_record(scene, points.triangle[i]),
                         .position = numbers(dvec3(points.position(i))),
                         .light    = scene.lights[light].name};
    record.decided = decided_in_words(scene, points, light, i);
    if (!record.decided.empty()) return record;
    const auto answer = [&](MethodAtWork work) {
        work.limit(most);
        AnswerHereRecord here;
        if (const Service service = work.service(); service)
            here.answer = answer_record(work, points, i, light);
        else
            here.answer = {.method = work.choice().text(), .not_served = service.why};
        here.sentence = sentence(here.answer);
        if (here.answer.blocker)
            for (int k = 0; k < 3; ++k)
                here.blocker_corners.push_back(numbers(dvec3(scene.vertex(here.answer.blocker->triangle, k))));
        record.answers.push_back(std::move(here));
    };
    sides_.resize(choices.size());
    for (std::size_t k = 0; k < choices.size(); ++k) {
        run(sides_[k], choices[k], most, false);
        answer(sides_[k].method->at_work());
    }
    if (is_area(scene.lights[light].kind)) record.seen = seen_light(i, scene.lights[light]);
    answer(truth_ && truth_->run.work ? *truth_->run.work
                                      : MethodAtWork(default_reference(posed_.facts()).choice, scene, posed_.facts()));
    // The truth is that of areas: another measure is no error.
    for (std::size_t k = 0; k < choices.size(); ++k)
        if (choices[k].make()->measures() == Measure::area)
            add_difference(record.answers[k].answer, record.answers.back().answer, scene, points, i, light);
    return record;
}

std::string ViewSession::scene_text() const { return native_text(posed_.scene()); }

ViewedSceneRecord ViewSession::scene_record() const {
    const Scene& scene     = posed_.as_in_file();
    const CameraFrame view = frame(scene.camera, scene.width, scene.height);
    const Box box          = posed_.facts().box;
    ViewedSceneRecord record{.name         = scene.name,
                             .title        = scene.title,
                             .shows        = scene.shows,
                             .width        = static_cast<std::uint64_t>(scene.width),
                             .height       = static_cast<std::uint64_t>(scene.height),
                             .frames       = static_cast<std::uint64_t>(scene.frames),
                             .triangles    = scene.triangles.size(),
                             .eye          = numbers(dvec3(scene.camera.eye)),
                             .target       = numbers(dvec3(scene.camera.target)),
                             .up           = numbers(dvec3(scene.camera.up)),
                             .low          = numbers(dvec3(box.min)),
                             .high         = numbers(dvec3(box.max)),
                             .orthographic = scene.camera.projection == Projection::orthographic,
                             .half_width   = view.half_width,
                             .half_height  = view.half_height,
                             .warnings     = scene.warnings};
    for (const Light& light : scene.lights) {
        const double edge = std::max(glm::length(light.edge_u), glm::length(light.edge_v)) / 2;
        record.lights.push_back({.name      = light.name,
                                 .kind      = std::string(to_string(light.kind)),
                                 .position  = numbers(dvec3(light.position)),
                                 .direction = numbers(dvec3(light.direction)),
                                 .extent    = light.kind == LightKind::rectangle ? edge : double(light.radius),
                                 .fixed     = light.camera_pose.has_value()});
    }
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
        record.objects.push_back(
            {.name = scene.objects[o].name, .movable = posed_.is_movable(o), .middle = numbers(posed_.middle(o))});
    for (const MethodInfo* info : methods()) record.methods.push_back(method_info_record(*info));
    return record;
}

}  // namespace umbra
