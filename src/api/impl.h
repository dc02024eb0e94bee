#pragma once

#include <optional>
#include <vector>

#include "base/image.h"
#include "film/film.h"
#include "inktrace/render.h"
#include "inktrace/scene.h"
#include "inktrace/settings.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "vector/line_art.h"

/// What the public classes hold.

struct inktrace::Settings::Impl {
    ink::Settings settings;
};

struct inktrace::Scene::Impl {
    std::vector<ink::Object> objects;
};

struct inktrace::Picture::Impl {
    ink::Film film;
    double dpi;
    std::vector<ink::Aov> aovs;
    ink::Metadata metadata;
    RenderStats stats;
    std::optional<ink::LineArt> line_art{};
};
