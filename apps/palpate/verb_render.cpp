// SPDX-License-Identifier: Apache-2.0
// palpate render IN -o OUT.png: pictures and depths of an isosurface, without a display.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/console/message.hpp"
#include "apps/render/render_options.hpp"
#include "apps/render/render_words.hpp"
#include "base/json_text.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

struct RenderArguments {
  RenderRequest request;
  std::vector<std::vector<std::string>> given;  // by row of the table
};

void addRenderOptions(CLI::App& verb, RenderArguments& arguments) {
  const std::vector<RenderOption>& rows = renderOptions();
  arguments.given.resize(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RenderOption& row = rows[i];
    std::vector<std::string>& given = arguments.given[i];
    if (row.isBare()) {
      verb.add_flag_callback(
          row.flag, [&given] { given.emplace_back(); }, optionHelp(row));
      continue;
    }
    CLI::Option* option = row.most > 1
                              ? verb.add_option(row.flag, given, optionHelp(row))
                              : verb.add_option_function<std::string>(
                                    row.flag, [&given](const std::string& text) { given = {text}; }, optionHelp(row));
    option->allow_extra_args(false);  // the next word may be the volume
    // Completion reads the words from the type's name.
    option->type_name(row.words.empty() ? row.placeholder : fmt::format("{{{}}}", fmt::join(row.words, ",")));
  }
}

}  // namespace

void addRenderVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("render", "draw the isosurface of a volume into files; needs no display");
  verb->footer(
      "World: LPS, mm. A depth image is a PFM file: metres along each pixel's ray, infinity where nothing is hit.\n"
      "Example: palpate render scan.nii.gz -o half.png --view left --clip x=50% --depth half.pfm\n"
      "docs/render.md explains views, planes and files");
  auto arguments = std::make_shared<RenderArguments>();
  RenderRequest& request = arguments->request;
  verb->add_option("in", request.in, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("-o,--out", request.out, "the picture to write: .png")->required()->type_name("OUT.png");
  verb->add_option("--depth", request.depth, "write a depth image into this file too: .pfm")
      ->type_name("FILE.pfm")
      ->check(notEmpty);
  verb->add_option("--json", request.json, "write the result, with each picture's camera, into this file too")
      ->type_name("FILE")
      ->check(notEmpty);
  addRenderOptions(*verb, *arguments);
  addVolumeOptions(*verb, request.in);
  verb->callback([arguments] {
    RenderRequest& asked = arguments->request;
    setRenderOptions(arguments->given, asked);
    Progress progress;
    const RenderResult result = render(asked, progress);
    if (!asked.json.empty()) writeFileAtomically(asked.json, jsonFileText(renderJson(asked, result)));
    printText(renderWords(asked, result));
  });
}

}  // namespace palpate
