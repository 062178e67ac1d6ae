// SPDX-License-Identifier: Apache-2.0
// apps/render/render_words.hpp: what `palpate render` did, for people and for programs. Any thread.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "apps/render/render_job.hpp"
#include "apps/render/render_request.hpp"

namespace palpate {

// Some lines, each ending in a newline: what was drawn, from where, how much is seen, time, files.
[[nodiscard]] std::string renderWords(const RenderRequest& request, const RenderResult& result);

// Schema palpate.render/1 (docs/render.md). With the camera of each picture a program finds the point of the world that
// a pixel of the depth image shows.
[[nodiscard]] nlohmann::ordered_json renderJson(const RenderRequest& request, const RenderResult& result);

}  // namespace palpate
