#include "core/methods/equal_importance/equal_importance.h"

#include "core/methods/equal_importance/contour_blend.h"
#include "core/methods/stack/layer_mesher.h"

namespace sonoloft {
namespace {

constexpr const char* kName = "equal-importance";

Result<MethodSurfaces> run(const MethodInput& input) {
  const ContourForm form = input.settings.at("form") == "sparse" ? ContourForm::sparse : ContourForm::dense;
  return equal_importance(input.slices, {input.spacing_mm, form, input.threads});
}

}  // namespace

Result<MethodSurfaces> equal_importance(std::span<const TrackedSlice> slices, const EqualImportanceOptions& options) {
  const auto charted = chart_of(slices, kName);
  if (!charted) return tl::unexpected<Error>(charted.error());
  if (auto fits = check_size(charted->box.sizes(), options.spacing_mm, charted->sections.size()); !fits)
    return tl::unexpected<Error>(fits.error());
  auto mesh = mesh_of(ContourBlend(*charted, options), charted->sections, options.threads);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  return MethodSurfaces{moved(std::move(*mesh), charted->frame_to_reference), {}};
}

Method equal_importance_method() {
  return {kName,
          "two or more slices, parallel, along a curve or about an axis, one or many labels",
          {{"form",
            "how contours are joined: by blended distances, or for few nested ones by equal shares of the way",
            "dense",
            {"dense", "sparse"}}},
          run};
}

}  // namespace sonoloft
